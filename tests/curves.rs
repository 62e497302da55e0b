//! Curves: the papers' systems on both backends, their words in closed form, and chunks that nobody sees.

#[cfg(feature = "gpu")]
use crate::device;
use burgeon::cpu::{self, Cpu};
use burgeon::curve::{Axiom, Word};
use burgeon::language::{System, Value};
use burgeon::plan::derive::{Backend, collect_curve, derive};
use burgeon::plan::{Options, Plan};
use std::fmt::Debug;

struct Job {
    plan: Plan,
    axiom: Axiom,
    options: Options<'static>,
}

fn job(text: &str, points: &[[f32; 4]], set: &[(&str, Value)]) -> Job {
    let system = System::parse(text).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&system).unwrap_or_else(|e| panic!("{e}"));
    let axiom = Axiom::load::<String>(&system, &mut |_| Ok(vec![points.to_vec()])).expect("an axiom");
    let set = set.iter().map(|(name, value)| (name.to_string(), value.clone())).collect();
    Job { plan, axiom, options: Options { set, ..Options::default() } }
}

impl Job {
    fn on<B: Backend>(&self, mut backend: B, steps: Option<u32>, chunk: Option<usize>) -> Word
    where
        B::Error: Debug,
    {
        let uniforms = self.plan.uniforms(&self.options.set).expect("params");
        let options = Options { steps, chunk_modules: chunk, ..self.options.clone() };
        let derivation = derive(&self.plan, &self.axiom, &uniforms, &options, &mut backend).expect("a word");
        collect_curve(&self.plan, &mut backend, &derivation).expect("a word")
    }
    fn cpu(&self, steps: Option<u32>, chunk: Option<usize>) -> Word {
        let uniforms = self.plan.uniforms(&self.options.set).expect("params");
        self.on(Cpu::new(&self.plan, &uniforms, 2).expect("threads"), steps, chunk)
    }
}

const CHAIKIN: &str = include_str!("data/language/chaikin.burgeon");

fn square() -> Vec<[f32; 3]> {
    let job = job(CHAIKIN, &[], &[]);
    let (word, derivation) = cpu::derive_curve(&job.plan, &job.axiom, &job.options, 1).expect("a word");
    assert_eq!(derivation.steps.len(), 3);
    word.points()
}

/// S6, S2: the square after one step and three.
#[test]
fn s6_the_square_has_32_points_after_three_steps() {
    let points = square();
    assert_eq!(points.len(), 32);
    let first = job(CHAIKIN, &[], &[]).cpu(Some(1), None).points();
    // P(0) is (0, 0), on its left (1, 0), on its right (0, 1).
    assert_eq!(first[..2], [[0.25, 0.0, 0.0], [0.0, 0.25, 0.0]]);
    assert_eq!(first.len(), 8);
}

#[test]
fn chunks_of_any_size_are_invisible() {
    for chunk in [1, 2, 3, 7, 64] {
        assert_eq!(job(CHAIKIN, &[], &[]).cpu(None, Some(chunk)).points(), square(), "chunks of {chunk}");
    }
}

#[cfg(feature = "gpu")]
#[test]
fn cpu_and_gpu_derive_the_same_curve() {
    for (name, engine) in device::engines() {
        let job = job(CHAIKIN, &[], &[]);
        let uniforms = job.plan.uniforms(&[]).expect("params");
        for chunk in [None, Some(1), Some(7)] {
            let gpu = burgeon::gpu::Gpu::new(&engine, &job.plan, &uniforms).expect("kernels");
            assert_eq!(job.on(gpu, None, chunk), job.cpu(None, None), "{name}, chunks of {chunk:?}");
        }
    }
}
