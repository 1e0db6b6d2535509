//! JSON that glTF allows, or that is only untidy, and that the `gltf` crate's types refuse: it is
//! changed so that they take it.
//!
//! Cost: linear in the document. Source: [glTF 2.0], sections 1.4 and 3.11 (`extras` may be
//!       anything, animations are not read).

use serde_json::{Map, Number, Value};

/// Changes `document` where nothing of the picture hangs on it:
///
/// * integers that are written as `1.0` become integers;
/// * `extras`, which may hold any value, are taken away, and animations, which are not read;
/// * a scene without a list of nodes and a skin without joints get empty lists.
pub(crate) fn mend(document: &mut Map<String, Value>) {
    document.remove("animations");
    for (list, field) in [("scenes", "nodes"), ("skins", "joints")] {
        for entry in document.get_mut(list).and_then(|v| v.as_array_mut()).into_iter().flatten() {
            if let Some(object) = entry.as_object_mut() {
                object.entry(field).or_insert_with(|| Value::Array(Vec::new()));
            }
        }
    }
    mend_object(document);
}

/// `serde_json` reads no more than 128 levels, so that the recursion has an end.
fn mend_object(object: &mut Map<String, Value>) {
    object.remove("extras");
    object.values_mut().for_each(mend_value);
}

fn mend_value(value: &mut Value) {
    match value {
        Value::Object(object) => mend_object(object),
        Value::Array(list) => list.iter_mut().for_each(mend_value),
        Value::Number(number) => {
            if let Some(whole) = whole(number) {
                *number = whole;
            }
        }
        _ => {}
    }
}

/// The integer that is written as a floating-point number.
fn whole(number: &Number) -> Option<Number> {
    const EXACT: f64 = (1u64 << 53) as f64;
    let value = number.as_f64().filter(|_| number.is_f64())?;
    (value.is_sign_positive() && value.fract() == 0.0 && value < EXACT)
        .then(|| Number::from(value as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_does_not_matter_changes() {
        let mut document = serde_json::json!({
            "animations": [{}],
            "nodes": [{"translation": [1.0, -2.0, 0.5], "extras": 7, "mesh": 1.0, "name": "extras"}],
            "scenes": [{}, {"nodes": [0]}],
            "skins": [{"joints": [3]}, {}, 1],
        });
        mend(document.as_object_mut().unwrap());
        let expected = serde_json::json!({
            "nodes": [{"translation": [1, -2.0, 0.5], "mesh": 1, "name": "extras"}],
            "scenes": [{"nodes": []}, {"nodes": [0]}],
            "skins": [{"joints": [3]}, {"joints": []}, 1],
        });
        assert_eq!(document, expected);
    }
}
