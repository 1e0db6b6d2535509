//! Values of lights as people type them: numbers, vectors, intensities, laws of attenuation. Each
//! parser says what it requires.

use crate::names;
use vitral_light::Attenuation;
use vitral_math::DVec3;

/// A finite number.
///
/// # Errors
/// A sentence on what is wrong, as from all parsers here.
pub fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a finite number")),
    }
}

/// A finite number above 0.
///
/// # Errors
/// As [`number`].
pub fn positive(text: &str) -> Result<f64, String> {
    number(text)
        .and_then(|v| if v > 0.0 { Ok(v) } else { Err("a number above 0 is required".to_owned()) })
}

/// A finite number of at least 0.
///
/// # Errors
/// As [`number`].
pub fn not_negative(text: &str) -> Result<f64, String> {
    number(text).and_then(|v| {
        if v >= 0.0 { Ok(v) } else { Err("a number of at least 0 is required".to_owned()) }
    })
}

/// `N` finite numbers, separated by commas.
///
/// # Errors
/// As [`number`].
pub fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let values = text.split(',').map(number).collect::<Result<Vec<f64>, String>>()?;
    let count = values.len();
    values.try_into().map_err(|_| format!("{N} numbers are required, `{text}` has {count}"))
}

/// A point or a direction, `x,y,z`.
///
/// # Errors
/// As [`number`].
pub fn vector(text: &str) -> Result<DVec3, String> {
    numbers::<3>(text).map(DVec3::from_array)
}

/// A direction, `x,y,z`, not all 0.
///
/// # Errors
/// As [`number`].
pub fn direction(text: &str) -> Result<DVec3, String> {
    let v = vector(text)?;
    if v.try_normalize().is_some() {
        Ok(v)
    } else {
        Err("a direction of some length is required".to_owned())
    }
}

/// `on` or `off`.
///
/// # Errors
/// As [`number`].
pub fn switch(text: &str) -> Result<bool, String> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(format!("`{text}` is not one of on, off")),
    }
}

/// One number for grey light, red, green and blue, or a colour's name; `raw` is the colour space in
/// which a name stands for its bytes, not for light.
///
/// # Errors
/// As [`number`].
pub fn intensity(text: &str, raw: bool) -> Result<[f32; 3], String> {
    if let Some(named) = if raw { names::color(text) } else { names::linear_color(text) } {
        return Ok(named);
    }
    let rgb = if text.contains(',') { numbers::<3>(text)? } else { [number(text)?; 3] };
    if rgb.iter().any(|&c| c < 0.0) {
        return Err("intensities of at least 0 are required".to_owned());
    }
    let single = rgb.map(|c| c as f32);
    if single.iter().all(|c| c.is_finite()) {
        Ok(single)
    } else {
        Err("finite intensities are required".to_owned())
    }
}

/// A half angle of a cone in degrees; gives radians.
///
/// # Errors
/// As [`number`].
pub fn half_angle(text: &str) -> Result<f64, String> {
    let degrees = number(text)?;
    if !(0.0..=90.0).contains(&degrees) {
        return Err("a half angle from 0 to 90 degrees is required".to_owned());
    }
    Ok(degrees.to_radians())
}

/// Corners of a polygon, three numbers each.
///
/// # Errors
/// As [`number`].
pub fn corners(text: &str) -> Result<Vec<DVec3>, String> {
    let values = text.split(',').map(number).collect::<Result<Vec<f64>, String>>()?;
    let (corners, rest) = values.as_chunks::<3>();
    if corners.len() < 3 || !rest.is_empty() {
        return Err(format!(
            "three numbers for each of at least three corners are required, not {}",
            values.len()
        ));
    }
    Ok(corners.iter().map(|&c| DVec3::from_array(c)).collect())
}

/// A law of attenuation: `none`, `inverse-square`, `c1,c2,c3` for the course's
/// `min(1 / (c1 + c2 d + c3 d²), 1)`, `gl,constant,linear,quadratic`, or `range,distance`.
///
/// # Errors
/// As [`number`].
pub fn attenuation(text: &str) -> Result<Attenuation, String> {
    let (form, rest) = text.split_once(',').unwrap_or((text, ""));
    let terms = |text: &str| -> Result<[f64; 3], String> {
        let terms = numbers::<3>(text)?;
        let sound = terms.iter().all(|&t| t >= 0.0) && terms.iter().any(|&t| t > 0.0);
        if sound {
            Ok(terms)
        } else {
            Err("three terms of at least 0, not all 0, are required".to_owned())
        }
    };
    match form {
        "none" if rest.is_empty() => Ok(Attenuation::None),
        "inverse-square" if rest.is_empty() => Ok(Attenuation::InverseSquare),
        "gl" => terms(rest).map(|[constant, linear, quadratic]| Attenuation::Gl {
            constant,
            linear,
            quadratic,
        }),
        "range" => positive(rest).map(|range| Attenuation::Range { range }),
        _ => terms(text).map(|[c1, c2, c3]| Attenuation::Clamped { c1, c2, c3 }),
    }
}
