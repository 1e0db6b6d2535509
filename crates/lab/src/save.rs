//! The texts that the page saves.

use crate::answer::Answer;
use crate::files::plain_name;
use crate::request::Saved;
use serde_json::json;
use vitral::{DrawingFormat, DrawingOptions, DrawingSettings, Renderer, State};

/// The state file, a command that makes the same picture, or a line drawing as SVG.
pub(crate) fn save(renderer: &mut Renderer, state: &State, what: Saved) -> Answer {
    let text = match what {
        Saved::State => with_plain_names(state).to_json(),
        Saved::Command => command(state),
        Saved::Drawing => {
            let drawing = renderer.draw(&DrawingSettings::default())?.drawing;
            String::from_utf8_lossy(
                &DrawingFormat::Svg.encode(&drawing, &DrawingOptions::default()),
            )
            .into_owned()
        }
    };
    Ok((json!({"text": text}), Vec::new()))
}

/// The state with models of the user's own called by their files, as the command line reads them.
fn with_plain_names(state: &State) -> State {
    let mut state = state.clone();
    for model in &mut state.models {
        if model.starts_with("file:") {
            *model = plain_name(model).to_owned();
        }
    }
    state
}

/// A shell command with the state, only what differs from the default, as a document in place.
fn command(state: &State) -> String {
    let state = &with_plain_names(state);
    let all = serde_json::to_value(state).unwrap_or_default();
    let defaults = serde_json::to_value(State::default()).unwrap_or_default();
    let mut differing = difference(&all, &defaults).unwrap_or_else(|| json!({}));
    differing["vitral"] = all["vitral"].clone();
    let name = state.models.first().map_or("picture", |model| plain_name(model));
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem).replace('\'', "'\\''");
    format!("vitral render --load-state - -o '{stem}.png' <<'STATE'\n{differing:#}\nSTATE\n")
}

/// The fields of `value` that differ from `default`, object by object; lists and tagged choices are
/// wholes.
fn difference(value: &serde_json::Value, default: &serde_json::Value) -> Option<serde_json::Value> {
    if value == default {
        return None;
    }
    match (value.as_object(), default.as_object()) {
        (Some(fields), Some(defaults)) if !fields.contains_key("type") => {
            let differing = fields.iter().filter_map(|(name, value)| {
                let other = defaults.get(name).unwrap_or(&serde_json::Value::Null);
                Some((name.clone(), difference(value, other)?))
            });
            Some(differing.collect())
        }
        _ => Some(value.clone()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_names_what_differs_alone() {
        let text = r#"{"models": ["file:a/bob's chair.obj#0123456789ab"], "settings": {"shading": "flat", "width": 64}}"#;
        let told = command(&State::from_json(text, "s").unwrap());
        let (first, rest) = told.split_once('\n').unwrap();
        assert_eq!(first, r"vitral render --load-state - -o 'a/bob'\''s chair.png' <<'STATE'");
        let state = rest.strip_suffix("\nSTATE\n").unwrap();
        let found: serde_json::Value = serde_json::from_str(state).unwrap();
        assert_eq!(
            found,
            json!({"vitral": 1, "models": ["a/bob's chair.obj"], "settings": {"shading": "flat", "width": 64}})
        );
    }
}
