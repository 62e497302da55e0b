//! How the values of flags are written.

use super::flags::Tolerance;
use burgeon::language::Value;
use burgeon::tessellate::lattice::MAX_DEPTH;
use burgeon::tessellate::level::LEAST_TOLERANCE;
use std::path::PathBuf;

pub fn tolerance(text: &str) -> Result<Tolerance, String> {
    let (number, unit): (&str, fn(f32) -> Tolerance) = match text.trim().strip_suffix("px") {
        Some(number) => (number.trim_end(), Tolerance::Pixels),
        None => (text.trim(), Tolerance::World),
    };
    match number.parse::<f32>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(unit(x)),
        // What is above 0 as it is written.
        Ok(_) if number.parse::<f64>().is_ok_and(|x| x > 0.0 && x < 1.0) || is_tiny(number) => {
            Err(format!("too small for single precision; the least is {LEAST_TOLERANCE:e}"))
        }
        Ok(_) if number.parse::<f64>().is_ok_and(|x| x > 1.0 && x.is_finite()) => {
            Err(format!("too large for single precision; the most is {:e}", f32::MAX))
        }
        _ => Err("write a number above 0, as in 0.01 (units of the model) or 0.5px (pixels)".to_string()),
    }
}

/// A number above 0 that even double precision has as 0.
fn is_tiny(number: &str) -> bool {
    let digits = number.split(['e', 'E']).next().unwrap_or_default();
    !number.starts_with('-')
        && digits.contains(|c: char| c.is_ascii_digit() && c != '0')
        && number.parse() == Ok(0.0f64)
}

pub fn depth() -> clap::builder::RangedI64ValueParser<u32> {
    clap::value_parser!(u32).range(0..=i64::from(MAX_DEPTH))
}

/// `NAME=VALUE`: an int, a float, true or false, or a vector `x,y[,z[,w]]`.
pub fn assignment(text: &str) -> Result<(String, Value), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, as in depth=4")?;
    let name = name.trim();
    if name.is_empty() {
        return Err("the name before = is missing".to_string());
    }
    Ok((name.to_string(), number(value.trim())?))
}

pub fn number(text: &str) -> Result<Value, String> {
    let float = |t: &str| match t.trim().parse::<f32>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("`{text}` is no number, true or false, or vector such as 0,0,4")),
    };
    if let Ok(i) = text.parse::<i32>() {
        return Ok(Value::Int(i));
    }
    let digits = text.strip_prefix('-').unwrap_or(text);
    if !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()) {
        let (low, high) = (i32::MIN, i32::MAX);
        return Err(format!("`{text}` lies outside int, {low} to {high}; as a float, write {text}.0"));
    }
    if let Ok(b) = text.parse::<bool>() {
        return Ok(Value::Bool(b));
    }
    let parts = text.trim_start_matches('(').trim_end_matches(')').split(',');
    let parts = parts.map(float).collect::<Result<Vec<f32>, String>>()?;
    match parts[..] {
        [x] => Ok(Value::Float(x)),
        [x, y] => Ok(Value::Vec2([x, y])),
        [x, y, z] => Ok(Value::Vec3([x, y, z])),
        [x, y, z, w] => Ok(Value::Vec4([x, y, z, w])),
        _ => Err(format!("`{text}` has {} components; a vector has 2 to 4", parts.len())),
    }
}

/// `QUERY=FILE`.
pub fn binding(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, file)) if !name.trim().is_empty() && !file.is_empty() => {
            Ok((name.trim().to_string(), PathBuf::from(file)))
        }
        _ => Err("write QUERY=FILE, as in heat=heat.csv".to_string()),
    }
}

pub fn point(text: &str) -> Result<[f32; 3], String> {
    let parts = text.trim().trim_start_matches('(').trim_end_matches(')').split(',');
    let parts: Vec<f32> = parts.map_while(|part| part.trim().parse().ok()).collect();
    if parts.len() == 3 && parts.iter().any(|x| !x.is_finite()) {
        return Err("the coordinates of a point must be finite numbers of single precision".to_string());
    }
    match number(text)? {
        Value::Vec3(point) => Ok(point),
        _ => Err(format!("`{text}` is no point; write three numbers, as in 0,1.5,4")),
    }
}

pub fn angle(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(x) if x > 0.0 && x < 180.0 => Ok(x),
        _ => Err("the angle lies between 0 and 180 degrees".to_string()),
    }
}

pub fn pixels(text: &str) -> Result<[f32; 2], String> {
    let side = |t: &str| t.parse::<u32>().ok().filter(|n| (1..=1 << 16).contains(n));
    match text.split_once('x').map(|(w, h)| (side(w), side(h))) {
        Some((Some(w), Some(h))) => Ok([w as f32, h as f32]),
        _ => Err(format!("`{text}` is no size of a screen; write 1280x720")),
    }
}

const SIZES: &str = "write a whole number of bytes, as in 4G or 500M";

pub fn bytes(text: &str) -> Result<u64, String> {
    let number = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match text[number.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => 1u64,
        "k" | "kb" | "kib" => 1 << 10,
        "m" | "mb" | "mib" => 1 << 20,
        "g" | "gb" | "gib" => 1 << 30,
        "t" | "tb" | "tib" => 1 << 40,
        _ => return Err(SIZES.to_string()),
    };
    let number: u64 = number.parse().map_err(|_| SIZES.to_string())?;
    number.checked_mul(unit).ok_or_else(|| "more bytes than 64 bits can count".to_string())
}

/// A seed: 32 bits, written as a number below 2³² or, as its two's complement, from -2³¹; in hexadecimal digits after
/// `0x`.
pub fn seed(text: &str) -> Result<u32, String> {
    let digits = text.trim();
    let (negative, digits) = match digits.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, digits),
    };
    let size = match digits.strip_prefix("0x").or(digits.strip_prefix("0X")) {
        Some(hex) if hex.bytes().all(|b| b.is_ascii_hexdigit()) => i64::from_str_radix(hex, 16),
        None if digits.bytes().all(|b| b.is_ascii_digit()) => digits.parse(),
        _ => "".parse(),
    };
    let value = size.map(|size| if negative { -size } else { size });
    match value {
        Ok(value) if (i64::from(i32::MIN)..=i64::from(u32::MAX)).contains(&value) => Ok(value as u32),
        _ => Err(format!(
            "a seed is a whole number from {} to {}, or 0x and hexadecimal digits",
            i32::MIN,
            u32::MAX
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_32_bits_however_they_are_written() {
        let cases = [
            ("0", 0),
            ("7", 7),
            ("4294967295", u32::MAX),
            ("-1", u32::MAX),
            ("-0x1", u32::MAX),
            ("0xffffffff", u32::MAX),
            ("0XfF", 255),
            ("-2147483648", 1 << 31),
            ("2147483648", 1 << 31),
        ];
        for (text, value) in cases {
            assert_eq!(seed(text), Ok(value), "{text}");
        }
        let wrong = [
            "",
            "-",
            "0x",
            "--1",
            "+1",
            "1.5",
            "0x-1",
            "0x+1",
            "4294967296",
            "-2147483649",
            "0x100000000",
            "x",
        ];
        for text in wrong.into_iter().chain(["99999999999999999999999", "0xg"]) {
            assert!(seed(text).is_err_and(|e| e.contains("-2147483648 to 4294967295")), "{text}");
        }
    }
}
