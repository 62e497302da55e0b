//! `burgeon selftest`: the conformance suite on the user's own device.

use super::{Failure, flags};

#[cfg(feature = "gpu")]
pub use on_device::selftest;

#[cfg(not(feature = "gpu"))]
pub fn selftest(_: &flags::Selftest) -> Result<(), Failure> {
    Err(Failure::Device("error: this burgeon was built without the feature gpu".to_string()))
}

#[cfg(feature = "gpu")]
mod on_device {
    use super::super::progress::Bar;
    use super::super::run::of_gpu;
    use super::super::{agreeing, counted, devices, print, stop};
    use super::{Failure, flags};
    use burgeon::conformance::{self, Case, Compared, Outcome, Row, Verdict};
    use burgeon::gpu::{self, Engine, Headless, Requirement};
    use std::time::{Duration, Instant};

    /// Runs the suite and prints a row a case.
    pub fn selftest(flags: &flags::Selftest) -> Result<(), Failure> {
        let start = Instant::now();
        let requirement = flags.adapter.as_deref().map_or(Requirement::Any, Requirement::Named);
        let open = || Headless::new(requirement).map(|d| (Engine::new(&d.device, &d.queue), d.info));
        let (engine, info) = open().map_err(of_gpu)?;
        let adapter = format!("{}, driver {}", devices::label(&info), devices::driver(&info));
        stop::watch();
        let cases = conformance::cases();
        let width = cases.iter().map(|c| c.name.chars().count()).max().unwrap_or(0);
        let bar = Bar::new();
        let mut each = |row: &Row| match flags.json {
            true => Ok(()),
            false => bar.above(|| print(&line(row, width))),
        };
        if !flags.json {
            let compared = "compared";
            print(&format!("{:width$}  {compared:45} {:>9}  result\n", "case", "time"))?;
        }
        let again = || open().ok().map(|(engine, _)| engine);
        let rows = run(&cases, engine, &again, &bar, &mut each);
        bar.clear();
        let rows = rows?;
        let time = start.elapsed();
        print(&match flags.json {
            true => format!("{}\n", json(&info, &rows, cases.len(), time)),
            false => format!("{}\n", total(&adapter, &rows, cases.len(), time)),
        })?;
        judge(&rows, cases.len())
    }

    /// Runs the cases one after another. After a loss the rest goes on with the device that `again`
    /// opens, if it does.
    fn run(
        cases: &[Case],
        mut engine: Engine,
        again: &dyn Fn() -> Option<Engine>,
        bar: &Bar,
        each: &mut dyn FnMut(&Row) -> Result<(), Failure>,
    ) -> Result<Vec<Row>, Failure> {
        let mut rows = Vec::new();
        for (n, case) in cases.iter().enumerate() {
            bar.case(n, cases.len(), &case.name);
            let row = case.run(&engine, Some(&stop::STOP));
            each(&row)?;
            let lost = matches!(row.outcome, Outcome::Failed(gpu::Error::Lost { .. }));
            let stopped = matches!(row.outcome, Outcome::Stopped);
            rows.push(row);
            match lost.then(again) {
                _ if stopped => break,
                None => {}
                Some(Some(other)) => engine = other,
                Some(None) => break,
            }
        }
        Ok(rows)
    }

    /// What the rows say, as an exit status.
    fn judge(rows: &[Row], of: usize) -> Result<(), Failure> {
        let count = |test: fn(&Outcome) -> bool| rows.iter().filter(|r| test(&r.outcome)).count();
        let (differ, failed) =
            (count(|o| matches!(o, Outcome::Differs(_))), count(|o| matches!(o, Outcome::Failed(_))));
        match conformance::verdict(rows) {
            Verdict::Agree => Ok(()),
            Verdict::Differ => {
                Err(Failure::Differ(format!("error: CPU and GPU differ in {differ} of {of} cases")))
            }
            Verdict::Failed => {
                let left = of - rows.len();
                let were = agreeing(left as u64, "was", "were");
                let rest = if left > 0 { format!("; {left} {were} not tried") } else { String::new() };
                Err(Failure::Device(format!("error: the device failed in {failed} of {of} cases{rest}")))
            }
            Verdict::Stopped => {
                let ran = rows.len() - 1;
                Err(Failure::Stopped(format!("error: stopped by Ctrl-C after {ran} of {of} cases")))
            }
        }
    }

    fn line(row: &Row, width: usize) -> String {
        let Row { name, compared, outcome, time } = row;
        format!("{name:width$}  {:45} {:>6} ms  {outcome}\n", what(compared), time.as_millis())
    }

    fn what(compared: &Compared) -> String {
        let Compared { runs, passes, values, .. } = *compared;
        if runs == 0 {
            return String::new();
        }
        let passes = if passes > runs { format!("{}, ", sweeps(passes)) } else { String::new() };
        format!("{}, {passes}{}", counted(runs, "run"), counted(values, "word"))
    }

    fn sweeps(n: u64) -> String {
        counted(n, "sweep")
    }

    fn total(adapter: &str, rows: &[Row], of: usize, time: Duration) -> String {
        let agree = rows.iter().filter(|r| matches!(r.outcome, Outcome::Equal | Outcome::Within(_))).count();
        let words = rows.iter().map(|r| r.compared.values).sum();
        let (words, seconds) = (counted(words, "word"), time.as_secs_f64());
        let agreed = agreeing(agree as u64, "agrees", "agree");
        format!("{agree} of {of} cases {agreed}, {words} compared in {seconds:.1} s on {adapter}")
    }

    fn json(info: &wgpu::AdapterInfo, rows: &[Row], of: usize, time: Duration) -> serde_json::Value {
        let milliseconds = |t: Duration| t.as_secs_f64() * 1e3;
        let cases: Vec<_> = rows
            .iter()
            .map(|row| {
                let (result, message) = match &row.outcome {
                    Outcome::Equal => ("equal", None),
                    Outcome::Within(_) => ("within", None),
                    Outcome::Differs(what) => ("differs", Some(what.clone())),
                    Outcome::Failed(e) => ("failed", Some(e.to_string())),
                    Outcome::Stopped => ("stopped", None),
                };
                let Compared { runs, passes, values, rounding } = row.compared;
                serde_json::json!({
                    "case": row.name, "result": result, "message": message, "runs": runs,
                    "sweeps": passes, "words": values, "of_bound": rounding, "ms": milliseconds(row.time),
                })
            })
            .collect();
        serde_json::json!({
            "adapter": info.name, "backend": format!("{:?}", info.backend).to_lowercase(),
            "driver": devices::driver(info), "of": of, "cases": cases, "total_ms": milliseconds(time),
            "agree": rows.len() == of && conformance::verdict(rows) == Verdict::Agree,
        })
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        fn row(outcome: Outcome) -> Row {
            Row { name: "case".to_string(), compared: Compared::default(), outcome, time: Duration::ZERO }
        }

        fn status(outcomes: Vec<Outcome>, of: usize) -> u8 {
            let rows: Vec<Row> = outcomes.into_iter().map(row).collect();
            judge(&rows, of).map_or_else(|failure| failure.parts().0, |()| 0)
        }

        fn differs() -> Outcome {
            Outcome::Differs("emit".to_string())
        }

        fn failed() -> Outcome {
            Outcome::Failed(gpu::Error::Lost { doing: "this" })
        }

        #[test]
        fn what_the_rows_say_is_the_exit_status() {
            assert_eq!(status(vec![Outcome::Equal, Outcome::Within(0.5)], 2), 0);
            assert_eq!(status(vec![Outcome::Equal, differs()], 2), 4);
            assert_eq!(status(vec![differs(), failed()], 2), 4);
            assert_eq!(status(vec![Outcome::Equal, failed()], 9), 3);
            assert_eq!(status(vec![failed(), Outcome::Stopped], 9), 3);
            assert_eq!(status(vec![Outcome::Equal, Outcome::Stopped], 9), 130);
        }

        #[test]
        fn a_row_says_what_was_compared_and_what_came_of_it() {
            let compared = Compared { runs: 4, passes: 1200, values: 123_456, rounding: 0.0 };
            let equal = Row { compared, ..row(Outcome::Equal) };
            let text = "case  4 runs, 1,200 sweeps, 123,456 words                0 ms  equal\n";
            assert_eq!(line(&equal, 4), text);
            assert!(line(&row(differs()), 4).ends_with("0 ms  DIFFERS: emit\n"));
            assert!(line(&row(Outcome::Within(0.25)), 4).ends_with("within 0.250 of the bound\n"));
        }
    }
}
