//! Values as users type them: sizes, colours, vectors, numbers with a range. Each parser says what
//! it requires.

use crate::exit::hint;
use crate::report::Failure;
use crate::similar::not_one_of;
use clap::builder::{PathBufValueParser, TypedValueParser};
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;
use vitral::bench::Entrant;
use vitral::explain::Deciders;
use vitral::internals::math::lanes::level_from_environment;
pub(crate) use vitral::light_text::{
    direction, not_negative, number, numbers, positive, switch, vector,
};
use vitral::{
    Coherence, Culling, Execution, LightEdit, MaterialOverride, UnknownName, Visibility, Workers,
    execution, names,
};

/// A finite number of at least 0, in single precision.
pub(crate) fn intensity(text: &str) -> Result<f32, String> {
    not_negative(text).and_then(|v| {
        let single = v as f32;
        if single.is_finite() {
            Ok(single)
        } else {
            Err(format!("a number of at most {:e} is required", f32::MAX))
        }
    })
}

/// Two distances, the nearer first.
pub(crate) fn distances(text: &str) -> Result<(f64, f64), String> {
    let [near, far] = numbers(text)?;
    if near < far {
        Ok((near, far))
    } else {
        Err("two distances are required, the nearer first".to_owned())
    }
}

/// A share, `0..=1`.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    number(text).and_then(|v| {
        if (0.0..=1.0).contains(&v) {
            Ok(v)
        } else {
            Err("a number from 0 to 1 is required".to_owned())
        }
    })
}

/// An angle of view in degrees, above 0 and below 180.
pub(crate) fn view_angle(text: &str) -> Result<f64, String> {
    number(text).and_then(|v| {
        if v > 0.0 && v < 180.0 {
            Ok(v)
        } else {
            Err("an angle between 0 and 180 degrees is required".to_owned())
        }
    })
}

/// An angle between faces in degrees, 0 to 180.
pub(crate) fn half_turn(text: &str) -> Result<f64, String> {
    number(text).and_then(|v| {
        if (0.0..=180.0).contains(&v) {
            Ok(v)
        } else {
            Err("an angle from 0 to 180 degrees is required".to_owned())
        }
    })
}

/// A width of lines in pixels.
pub(crate) fn line_width(text: &str) -> Result<f32, String> {
    intensity(text).and_then(|v| {
        if (0.1..=64.0).contains(&v) {
            Ok(v)
        } else {
            Err("a number from 0.1 to 64 is required".to_owned())
        }
    })
}

/// An exponent above 0, in single precision.
pub(crate) fn exponent(text: &str) -> Result<f32, String> {
    intensity(text)
        .and_then(|v| if v > 0.0 { Ok(v) } else { Err("a number above 0 is required".to_owned()) })
}

/// A number of threads; 0 lets the machine decide.
pub(crate) fn threads(text: &str) -> Result<usize, String> {
    whole(0..=Workers::MOST)(text)
}

/// The number of threads that was asked for, else what `VITRAL_THREADS` says, else 0.
pub(crate) fn threads_or_environment(asked: Option<usize>) -> Result<usize, Failure> {
    match (asked, std::env::var("VITRAL_THREADS")) {
        (Some(count), _) => Ok(count),
        // Empty is as good as not set.
        (None, Ok(text)) if !text.trim().is_empty() => {
            threads(&text).map_err(|e| Failure::usage(format!("VITRAL_THREADS={text}: {e}")))
        }
        (None, _) => Ok(0),
    }
}

/// How to compute, with as many threads as were asked for. The environment variable `VITRAL_SIMD`
/// may name another instruction set than the best.
pub(crate) fn execution_from(threads: Option<usize>) -> Result<Execution, Failure> {
    let execution = execution(threads_or_environment(threads)?);
    // Empty is as good as not set.
    let is_set = std::env::var_os("VITRAL_SIMD").is_some_and(|name| !name.is_empty());
    let level =
        if is_set { level_from_environment().map_err(Failure::usage)? } else { execution.level };
    Ok(Execution { level, ..execution })
}

/// A number of samples a pixel.
pub(crate) fn samples(text: &str) -> Result<u32, String> {
    match text.trim().parse() {
        Ok(count @ (1..=16 | 32)) => Ok(count),
        _ => Err("a whole number from 1 to 16, or 32, is required".to_owned()),
    }
}

/// A parser of whole numbers from a range.
pub(crate) fn whole<T>(
    range: RangeInclusive<T>,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static
where
    T: FromStr + PartialOrd + Display + Clone + Send + Sync + 'static,
{
    move |text| match text.trim().parse() {
        Ok(value) if range.contains(&value) => Ok(value),
        _ => Err(format!("a whole number from {} to {} is required", range.start(), range.end())),
    }
}

/// `1024x768` or `1024,768`.
pub(crate) fn resolution(text: &str) -> Result<[u32; 2], String> {
    let wrong =
        || format!("`{text}` is not a size: two whole numbers such as 1024x768 are required");
    let (width, height) = text.split_once(['x', 'X', ',']).ok_or_else(wrong)?;
    match (width.trim().parse(), height.trim().parse()) {
        (Ok(width), Ok(height)) => Ok([width, height]),
        _ => Err(wrong()),
    }
}

/// A colour in the display's encoding, `0..=1`: a name, `#rgb`, `#rrggbb` or `r,g,b`.
pub(crate) fn color(text: &str) -> Result<[f32; 3], String> {
    if let Some(named) = names::color(text) {
        return Ok(named);
    }
    match numbers::<3>(text) {
        Ok(rgb) if rgb.iter().all(|c| (0.0..=1.0).contains(c)) => Ok(rgb.map(|c| c as f32)),
        _ => Err(format!(
            "`{text}` is not a colour: a name, #rrggbb or r,g,b from 0 to 1 is required"
        )),
    }
}

/// A number of bytes: `1000000`, `512M`, `1.5G` (powers of 1024).
pub(crate) fn bytes(text: &str) -> Result<u64, String> {
    let wrong = || {
        format!(
            "`{text}` is not an amount of memory: a number of bytes, or one followed by K, M or G, is required"
        )
    };
    let upper = text.trim().to_ascii_uppercase();
    let upper = upper.strip_suffix("IB").or_else(|| upper.strip_suffix('B')).unwrap_or(&upper);
    let (digits, unit) = match upper.chars().last() {
        Some('K') => (&upper[..upper.len() - 1], 1u64 << 10),
        Some('M') => (&upper[..upper.len() - 1], 1 << 20),
        Some('G') => (&upper[..upper.len() - 1], 1 << 30),
        Some('T') => (&upper[..upper.len() - 1], 1 << 40),
        _ => (upper, 1),
    };
    match number(digits) {
        Ok(count) if count > 0.0 => Ok((count * unit as f64).min(u64::MAX as f64) as u64),
        _ => Err(wrong()),
    }
}

/// `frustum,back-face`, one of them, or `none`.
pub(crate) fn culling(text: &str) -> Result<Culling, String> {
    let mut culling = Culling { frustum: false, back_face: false };
    for word in text.split(',') {
        match &*word.to_ascii_lowercase() {
            "frustum" => culling.frustum = true,
            "back-face" => culling.back_face = true,
            "none" if word == text => {}
            _ => return Err(not_one_of(word, &["frustum", "back-face"], "; or none alone")),
        }
    }
    Ok(culling)
}

/// Kinds of coherence, as one value; `None`: all that the algorithm exploits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct CoherenceList(pub(crate) Option<Vec<Coherence>>);

/// Kinds of coherence with commas between them, or `all`, or `none`.
pub(crate) fn coherence(text: &str) -> Result<CoherenceList, String> {
    match &*text.to_ascii_lowercase() {
        "none" => return Ok(CoherenceList(Some(Vec::new()))),
        // Each algorithm has kinds of its own: a list of all would name some that it has not.
        "all" => return Ok(CoherenceList(None)),
        _ => {}
    }
    let kind = |word: &str| {
        let is_named = |(_, name): &&(_, &str)| name.eq_ignore_ascii_case(word);
        let names: Vec<_> = Coherence::ALL.iter().map(|(_, name)| *name).collect();
        let found = Coherence::ALL.iter().find(is_named).map(|(kind, _)| *kind);
        found.ok_or_else(|| not_one_of(word, &names, "; or all or none alone"))
    };
    text.split(',').map(kind).collect::<Result<_, _>>().map(|kinds| CoherenceList(Some(kinds)))
}

/// Frames a second.
pub(crate) fn frame_rate(text: &str) -> Result<f64, String> {
    number(text).and_then(|v| {
        if (0.1..=100.0).contains(&v) {
            Ok(v)
        } else {
            Err("a number from 0.1 to 100 is required".to_owned())
        }
    })
}

/// A pixel, `x,y` from the top left.
pub(crate) fn pixel(text: &str) -> Result<[u32; 2], String> {
    let wrong =
        || format!("`{text}` is not a pixel: two whole numbers such as 320,240 are required");
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    match (x.trim().parse(), y.trim().parse()) {
        (Ok(x), Ok(y)) => Ok([x, y]),
        _ => Err(wrong()),
    }
}

/// The entrants that names of visibility algorithms stand for, separated by commas, or `all`: an
/// algorithm that casts rays enters once with each acceleration structure.
pub(crate) fn deciders(text: &str) -> Result<Deciders, String> {
    let all = Entrant::all();
    if text.eq_ignore_ascii_case("all") {
        return Ok(Deciders::Named(all));
    }
    let mut named = Vec::new();
    for name in text.split(',').map(str::trim) {
        let chosen: Visibility =
            name.to_ascii_lowercase().parse().map_err(|unknown: UnknownName| {
                let nearest = unknown
                    .suggestion
                    .map(|name| format!("; did you mean `{name}`?"))
                    .unwrap_or_default();
                format!("`{name}` is not one of all, {}{nearest}", unknown.choices)
            })?;
        named.extend(all.iter().filter(|entrant| entrant.algorithm.name == chosen.name));
    }
    Ok(Deciders::Named(named))
}

/// Frames of a turntable: `3` or `0-9`, both ends included.
pub(crate) fn frames(text: &str) -> Result<RangeInclusive<u32>, String> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    match (first.parse(), last.parse()) {
        (Ok(first), Ok(last)) if first <= last => Ok(first..=last),
        _ => Err(format!(
            "`{text}` is not a range of frames: one number or two such as 0-9 are required"
        )),
    }
}

/// A material override `NAME.PROPERTY=VALUE`.
pub(crate) fn material(text: &str) -> Result<MaterialOverride, String> {
    MaterialOverride::parse(text).map_err(with_hint)
}

/// An edit of a light `LIGHT.FIELD=VALUE`.
pub(crate) fn light_edit(text: &str) -> Result<LightEdit, String> {
    LightEdit::parse(text).map_err(with_hint)
}

/// An error and its hint, in one line.
fn with_hint(error: vitral::Error) -> String {
    match hint(&error) {
        Some(hint) => format!("{error}; {hint}"),
        None => error.to_string(),
    }
}

/// The name of an OBJ file.
pub(crate) fn obj_file() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(as_obj_file)
}

fn as_obj_file(path: PathBuf) -> Result<PathBuf, String> {
    let is_obj = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    if is_obj { Ok(path) } else { Err("only .obj files are written".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral::DVec3;

    #[test]
    fn sizes_and_amounts() {
        assert_eq!(resolution("1024x768"), Ok([1024, 768]));
        assert_eq!(resolution("8,9"), Ok([8, 9]));
        assert!(
            ["", "8", "8x", "x8", "8x9x1", "-1x2", "1.5x2"].iter().all(|t| resolution(t).is_err())
        );
        assert_eq!(bytes("1G"), Ok(1 << 30));
        assert_eq!(bytes("1.5m"), Ok(3 << 19));
        assert_eq!(bytes("512MiB"), Ok(512 << 20));
        assert_eq!(bytes("77"), Ok(77));
        assert!(["", "G", "-1M", "0", "nanG", "1X"].iter().all(|t| bytes(t).is_err()));
        assert_eq!(frames("3"), Ok(3..=3));
        assert_eq!(frames("0-9"), Ok(0..=9));
        assert!(frames("9-0").is_err() && frames("-").is_err());
    }

    #[test]
    fn colors_and_vectors() {
        assert_eq!(color("White"), Ok([1.0; 3]));
        assert_eq!(color("#f00"), Ok([1.0, 0.0, 0.0]));
        assert_eq!(color("#0000FF"), Ok([0.0, 0.0, 1.0]));
        assert_eq!(color("0.5,0,1"), Ok([0.5, 0.0, 1.0]));
        assert!(
            ["#12", "#+12345", "#gggggg", "1,2,3", "1,1", "nowhere"]
                .iter()
                .all(|t| color(t).is_err())
        );
        assert_eq!(vector("1,-2,3e1"), Ok(DVec3::new(1.0, -2.0, 30.0)));
        assert!(
            vector("1,2").is_err() && vector("1,2,inf").is_err() && direction("0,0,0").is_err()
        );
    }

    #[test]
    fn coherence_is_a_list_or_none() {
        assert_eq!(
            coherence("edge,scan-line"),
            Ok(CoherenceList(Some(vec![Coherence::Edge, Coherence::ScanLine])))
        );
        assert_eq!(coherence("none"), Ok(CoherenceList(Some(Vec::new()))));
        assert_eq!(coherence("all"), Ok(CoherenceList(None)));
        assert!(coherence("none,edge").is_err() && coherence("").is_err());
        assert_eq!(pixel("3, 4"), Ok([3, 4]));
        assert!(["", "3", "3,", "-1,2", "1,2,3"].iter().all(|t| pixel(t).is_err()));
    }

    #[test]
    fn threads_are_some() {
        assert_eq!((threads("0"), threads("1024")), (Ok(0), Ok(1024)));
        assert!(["1025", "1000000", "-1", "two", ""].iter().all(|t| threads(t).is_err()));
        assert_eq!(
            whole(1..=16u32)("x"),
            Err("a whole number from 1 to 16 is required".to_owned())
        );
        assert_eq!(threads_or_environment(Some(3)).ok(), Some(3));
    }

    #[test]
    fn culling_is_a_list_or_none() {
        assert_eq!(culling("frustum,back-face"), Ok(Culling { frustum: true, back_face: true }));
        assert_eq!(culling("back-face"), Ok(Culling { frustum: false, back_face: true }));
        assert_eq!(culling("none"), Ok(Culling { frustum: false, back_face: false }));
        assert!(culling("none,frustum").is_err() && culling("").is_err());
    }
}
