//! Depth cueing as users type it: `color=black,front=2,back=9`.

use crate::fields::Fields;
use crate::values::{color, not_negative, share};
use vitral::DepthCue;

/// Reads the numbers; omitted ones have their defaults. Whether they go together is checked with
/// the other settings.
pub(crate) fn parse(text: &str) -> Result<DepthCue, String> {
    let mut fields = Fields::split(text)?;
    let default = DepthCue::default();
    let cue = DepthCue {
        color: fields.take("color", color)?,
        front: fields.take("front", not_negative)?,
        back: fields.take("back", not_negative)?,
        front_scale: fields.take("front-scale", share)?.map_or(default.front_scale, |s| s as f32),
        back_scale: fields.take("back-scale", share)?.map_or(default.back_scale, |s| s as f32),
    };
    match fields.unused() {
        Some(key) => Err(format!(
            "there is no key `{key}`; the keys are color, front, back, front-scale and back-scale"
        )),
        None => Ok(cue),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_has_its_default() {
        assert_eq!(parse(""), Ok(DepthCue::default()));
        let cue = parse("front=2,back=9.5,color=0,0.5,1,back-scale=0").unwrap();
        assert_eq!((cue.front, cue.back, cue.back_scale), (Some(2.0), Some(9.5), 0.0));
        assert_eq!((cue.color, cue.front_scale), (Some([0.0, 0.5, 1.0]), 1.0));
        for (text, part) in [
            ("near=1", "no key `near`"),
            ("front=-1", "front: "),
            ("back-scale=2", "0 to 1"),
            ("color=nowhere", "not a colour"),
            ("5", "no key"),
            ("front=1,front=2", "twice"),
        ] {
            assert!(parse(text).unwrap_err().contains(part), "{text}");
        }
    }
}
