//! Numbers that a built-in scene takes behind its name: `sphere?slices=8&stacks=4`.

use super::BuiltinError;

/// A whole number that a scene takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// What is typed before the equals sign.
    pub name: &'static str,
    /// One line for the user.
    pub about: &'static str,
    /// The least and the largest value.
    pub range: [u32; 2],
    /// The value where nothing is said.
    pub default: u32,
}

impl std::fmt::Display for Parameter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [least, most] = self.range;
        write!(f, "{}={} ({}, {least} to {most})", self.name, self.default, self.about)
    }
}

/// The values of `parameters` that `text` gives, the part behind the question mark; defaults for
/// the others.
pub(super) fn read(
    scene: &str,
    parameters: &[Parameter],
    text: &str,
) -> Result<Vec<u32>, BuiltinError> {
    let refused = |what: String| BuiltinError::Parameter { what, hint: hint(scene, parameters) };
    let mut values: Vec<u32> = parameters.iter().map(|parameter| parameter.default).collect();
    let mut given = vec![false; values.len()];
    for piece in text.split(['&', ',']).filter(|piece| !piece.is_empty()) {
        let (name, value) = piece.split_once('=').unwrap_or((piece, ""));
        let Some(number) = parameters.iter().position(|p| p.name.eq_ignore_ascii_case(name.trim()))
        else {
            return Err(refused(format!("builtin:{scene} takes no `{name}`")));
        };
        if std::mem::replace(&mut given[number], true) {
            return Err(refused(format!("builtin:{scene}: `{name}` is given twice")));
        }
        let [least, most] = parameters[number].range;
        values[number] = value.trim().parse().ok().filter(|v| (least..=most).contains(v)).ok_or_else(|| {
            refused(format!("builtin:{scene}: {name} `{value}`: a whole number from {least} to {most} is required"))
        })?;
    }
    Ok(values)
}

/// What a scene takes.
fn hint(scene: &str, parameters: &[Parameter]) -> String {
    if parameters.is_empty() {
        return format!("builtin:{scene} takes no parameters");
    }
    let list: Vec<String> = parameters.iter().map(ToString::to_string).collect();
    format!("builtin:{scene} takes {}", list.join(", "))
}
