//! `vitral info`: the contents of a model file.

use crate::args::InfoArgs;
use crate::report::{self, Failure};
use crate::values;
use serde_json::{Value, json};
use vitral::{FileColors, LoadOptions, Workers, info, load_on};

/// Runs the verb; gives the exit code.
pub(crate) fn run(args: &InfoArgs) -> Result<u8, Failure> {
    let workers = Workers::new(values::threads_or_environment(args.threads)?);
    // Normals that the file has not would be told as if it had, and colours are told as the file
    // gives them.
    let options = LoadOptions {
        allow_external: args.allow_external,
        make_normals: false,
        file_colors: FileColors::Linear,
        ..LoadOptions::default()
    };
    let mut models = Vec::new();
    for model in &args.models {
        let scene = load_on(model, &options, &workers)?;
        // Warnings are results here: told once, and not in words if nobody wants them.
        let mut found = info::info_on(&scene, &workers)?;
        if args.quiet && !args.json {
            found.warnings.clear();
        }
        if args.json {
            let mut value = report::to_value(&found)?;
            if let Value::Object(fields) = &mut value {
                fields.insert("file".to_owned(), json!(model.to_string_lossy()));
            }
            models.push(value);
        } else {
            let text = found.to_string();
            report::print(model.as_os_str().as_encoded_bytes())?;
            report::print(format!("\n{}\n", text.trim_end()).as_bytes())?;
        }
    }
    if args.json {
        report::print_json(&json!({"models": models}))?;
    }
    Ok(0)
}
