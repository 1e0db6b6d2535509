//! The formula of illumination in force, in MathML: in the course's letters, then with the pixel's
//! numbers; and its values as a table.
//!
//! Source: the course, notes V, illumination: `I = Σ Ia ka f + S f (Id kd N·L + Is ks (R·V)ⁿ)`,
//!         with Blinn's `N·H`.

use serde_json::{Value, json};
use vitral::explain::Explanation;
use vitral::internals::math::func;
use vitral::internals::render::shading::pixel_light::{
    CoefficientValues, Evaluation, NumberedTerms,
};

/// The formula at a pixel; `null` where no light is computed.
pub(crate) fn formula(told: &Explanation, lights: &[String]) -> Value {
    let Some(point) = told.light.points.first() else { return Value::Null };
    let Some(evaluation) = point.evaluations.first() else {
        return without_lights(told);
    };
    json!({
        "model": point.model,
        "mathml": symbols(point.model),
        "numbers": numbers(point.model, evaluation, told),
        "values": values(evaluation, told, lights),
    })
}

/// The formula of a surface that shows its own colour: `I = ki`.
fn without_lights(told: &Explanation) -> Value {
    const GREEN: usize = 1;
    let own = three(told.light.straight);
    let (value, byte) = (number(told.light.straight[GREEN]), told.light.bytes[GREEN]);
    json!({
        "model": "constant",
        "mathml": math(&format!("<mi>I</mi><mo>=</mo>{}", identifier("k", "i"))),
        "numbers": math(&format!(
            "<msub><mi>I</mi><mtext>green</mtext></msub><mo>=</mo>{value}<mo>→</mo><mn>{byte}</mn>"
        )),
        "values": [
            {"symbol": "ki", "value": own, "meaning": "the surface's own colour", "setting": null},
            {
                "symbol": "I",
                "value": own,
                "meaning": "the sum of all samples, before it is encoded",
                "setting": null,
            },
            {
                "symbol": "bytes",
                "value": bytes(told),
                "meaning": "the pixel's bytes",
                "setting": null,
            },
        ],
    })
}

/// A formula of its own line.
fn math(content: &str) -> String {
    format!("<math xmlns=\"http://www.w3.org/1998/Math/MathML\" display=\"block\">{content}</math>")
}

/// The pixel's red, green and blue.
fn bytes(told: &Explanation) -> String {
    told.light.bytes[..3].iter().map(u8::to_string).collect::<Vec<_>>().join(" ")
}

fn identifier(name: &str, index: &str) -> String {
    if index.is_empty() {
        format!("<mi>{name}</mi>")
    } else {
        format!("<msub><mi>{name}</mi><mi>{index}</mi></msub>")
    }
}

/// A number with four significant digits.
fn number(value: f32) -> String {
    let decimals = match value.abs() {
        v if v < 0.01 => 6,
        v if v < 1.0 => 4,
        v if v < 100.0 => 3,
        _ => 1,
    };
    let text = format!("{value:.decimals$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    format!("<mn>{}</mn>", if matches!(text, "-0" | "") { "0" } else { text })
}

/// A number with six digits.
fn digits(value: f32) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The formula in letters.
fn symbols(model: &str) -> String {
    let dot = |a: &str, b: &str| {
        format!(
            "<mrow><mo>(</mo><mi mathvariant=\"bold\">{a}</mi><mo>·</mo><mi mathvariant=\"bold\">{b}</mi><mo>)</mo></mrow>"
        )
    };
    let i = |index: &str| identifier("I", index);
    let k = |index: &str| identifier("k", index);
    let ambient = format!("{}{}", i("a"), k("a"));
    let diffuse = format!("{}{}{}", i("d"), k("d"), dot("N", "L"));
    let specular = match model {
        "phong" => format!("{}{}<msup>{}<mi>n</mi></msup>", i("s"), k("s"), dot("R", "V")),
        "blinn-phong" => format!("{}{}<msup>{}<mi>n</mi></msup>", i("s"), k("s"), dot("N", "H")),
        "constant" | "ambient" | "lambert" => String::new(),
        _ => format!(
            "{}<mfrac><mrow><mi>F</mi><mi>D</mi><mi>G</mi></mrow><mrow><mn>4</mn>{}{}</mrow></mfrac>{}",
            i("s"),
            dot("N", "L"),
            dot("N", "V"),
            dot("N", "L")
        ),
    };
    if model == "ambient" {
        // No direction counts: the lights' ambient colours alone are added.
        return math(&format!(
            "<mi>I</mi><mo>=</mo>{}{}<mo>+</mo><munder><mo>∑</mo><mtext>lights</mtext></munder>{ambient}",
            i("A"),
            k("a")
        ));
    }
    let lit = if specular.is_empty() { diffuse } else { format!("{diffuse}<mo>+</mo>{specular}") };
    format!(
        "<math xmlns=\"http://www.w3.org/1998/Math/MathML\" display=\"block\"><mi>I</mi><mo>=</mo>{}{}<mo>+</mo>\
         <munder><mo>∑</mo><mtext>lights</mtext></munder><mrow><mo>(</mo>{ambient}<mo>+</mo><mi>S</mi>{}<mo>(</mo>{lit}<mo>)</mo>\
         <mo>)</mo></mrow></math>",
        i("A"),
        k("a"),
        identifier("f", "att")
    )
}

/// The formula with the green channel's numbers: each letter replaced by its value.
fn numbers(model: &str, evaluation: &Evaluation, told: &Explanation) -> String {
    const GREEN: usize = 1;
    let mut terms = vec![number(evaluation.ambient[GREEN])];
    for of_light in &evaluation.lights {
        let t = &of_light.terms;
        let [ambient, diffuse, specular] = [t.ambient, t.diffuse, t.specular].map(|c| c[GREEN]);
        let (CoefficientValues::Empirical { ka, kd, ks, shininess }, None) =
            (&evaluation.coefficients, t.irradiance)
        else {
            // Microfacets and areas of light are integrals, whose values stand for them.
            let sum = [ambient, diffuse, specular].map(number).join("<mo>+</mo>");
            terms.push(format!("<mrow><mo>(</mo>{sum}<mo>)</mo></mrow>"));
            continue;
        };

        // Write (Ia ka f + S f (Id kd N·L + Is ks cosⁿ)) with its numbers.
        let [i_a, i_d, i_s] = t.colors.map(|color| number(color[GREEN]));
        let times = |factors: &[String]| factors.join("<mo>·</mo>");
        let ambient = times(&[i_a, number(ka[GREEN]), number(t.ambient_intensity)]);
        if model == "ambient" {
            terms.push(ambient);
            continue;
        }
        let mut lit = times(&[i_d, number(kd[GREEN]), number(t.n_l)]);
        if let Some(highlight) = t.highlight.filter(|_| ks[GREEN] > 0.0) {
            let power =
                format!("<msup>{}{}</msup>", number(highlight.cosine.max(0.0)), number(*shininess));
            lit = format!("{lit}<mo>+</mo>{}", times(&[i_s, number(ks[GREEN]), power]));
        }
        let [s, f] = [number(t.visibility[GREEN]), number(t.intensity)];
        terms.push(format!(
            "<mrow><mo>(</mo>{ambient}<mo>+</mo>{s}<mo>·</mo>{f}<mo>·</mo><mo>(</mo>{lit}<mo>)</mo><mo>)</mo></mrow>"
        ));
    }

    // Write a line for each term, then their sum.
    let sum = number(evaluation.diffuse[GREEN] + evaluation.specular[GREEN]);
    let byte = told.light.bytes[GREEN];
    let line = |left: &str, sign: &str, right: &str| {
        format!("<mtr><mtd>{left}</mtd><mtd><mo>{sign}</mo></mtd><mtd>{right}</mtd></mtr>")
    };
    let mut lines = line("<msub><mi>I</mi><mtext>green</mtext></msub>", "=", &terms[0]);
    lines.extend(terms[1..].iter().map(|term| line("", "+", term)));
    lines += &line("", "=", &format!("{sum}<mo>→</mo><mn>{byte}</mn>"));
    format!(
        "<math xmlns=\"http://www.w3.org/1998/Math/MathML\" display=\"block\"><mtable>{lines}</mtable></math>"
    )
}

/// Symbols with their values and meanings; a setting is where the value can be changed.
fn values(evaluation: &Evaluation, told: &Explanation, lights: &[String]) -> Vec<Value> {
    let mut rows = Vec::new();
    let mut row = |symbol: String, value: String, meaning: &str, setting: Option<String>| {
        rows.push(
            json!({"symbol": symbol, "value": value, "meaning": meaning, "setting": setting}),
        );
    };

    // List the vectors.
    row("N".to_owned(), three(evaluation.normal), "unit normal, view space", None);
    row("V".to_owned(), three(evaluation.viewer), "unit vector to the viewer, view space", None);

    // List the coefficients of the material's model.
    match evaluation.coefficients {
        CoefficientValues::Empirical { ka, kd, ks, shininess } => {
            row(
                "ka".to_owned(),
                three(ka),
                "ambient coefficient of the material",
                Some("materials.ka".to_owned()),
            );
            row("kd".to_owned(), three(kd), "diffuse coefficient", Some("materials.kd".to_owned()));
            row(
                "ks".to_owned(),
                three(ks),
                "specular coefficient",
                Some("materials.ks".to_owned()),
            );
            row(
                "n".to_owned(),
                digits(shininess),
                "exponent of the highlight",
                Some("materials.shininess".to_owned()),
            );
        }
        CoefficientValues::Microfacet { base_color, metallic, roughness, occlusion } => {
            row(
                "base".to_owned(),
                three(base_color),
                "base colour",
                Some("materials.base-color".to_owned()),
            );
            row(
                "metallic".to_owned(),
                digits(metallic),
                "0 a dielectric, 1 a metal",
                Some("materials.metallic".to_owned()),
            );
            row(
                "roughness".to_owned(),
                digits(roughness),
                "roughness of the surface",
                Some("materials.roughness".to_owned()),
            );
            row("occlusion".to_owned(), digits(occlusion), "how much ambient light arrives", None);
        }
    }

    // List the ambient light of the scene.
    row(
        "IA ka".to_owned(),
        three(evaluation.ambient),
        "ambient light of the scene times ka",
        Some("ambient".to_owned()),
    );

    // List the values of each light.
    for of_light in &evaluation.lights {
        light_values(of_light, &lights[of_light.light], &mut row);
    }

    // List the sum and the pixel's bytes.
    row(
        "I".to_owned(),
        three(told.light.straight),
        "the sum of all samples, before it is encoded",
        None,
    );
    row("bytes".to_owned(), bytes(told), "the pixel's bytes", None);
    rows
}

/// The values of one light, which is called `name`; `row` adds a symbol with its value, meaning and
/// setting.
fn light_values(
    of_light: &NumberedTerms,
    name: &str,
    row: &mut impl FnMut(String, String, &str, Option<String>),
) {
    let t = &of_light.terms;
    let mut of = |symbol: &str, value: String, meaning: &str| {
        row(
            format!("{symbol} ({name})"),
            value,
            meaning,
            Some(format!("lights.{}", of_light.light)),
        );
    };

    // List the colours, the direction, and what distance and shadow leave of the light.
    let [ambient, diffuse, specular] = t.colors.map(three);
    of("Ia", ambient, "ambient colour of the light");
    of("Id", diffuse, "diffuse colour of the light");
    of("Is", specular, "specular colour of the light");
    of("L", three(t.l), "unit vector to the light, view space");
    of("N·L", digits(t.n_l), "cosine of the angle of incidence, 0 behind the surface");
    let degrees = |cosine: f32| digits(func::acos32(cosine.clamp(-1.0, 1.0)).to_degrees());
    of("θ", degrees(t.n_l), "angle of incidence, degrees; 90 behind the surface");
    if let Some(distance) = t.distance {
        of("d", digits(distance), "distance from the light");
    }
    of("f_att", digits(t.attenuation), "what distance leaves of the light");
    of("S", three(t.visibility), "which part arrives: 1 without shadow");

    // List the highlight.
    if let Some(highlight) = t.highlight {
        let (symbol, meaning) = match highlight.r {
            Some(_) => ("R·V", "cosine between the mirrored light and the viewer"),
            None => ("N·H", "cosine between the normal and the halfway vector"),
        };
        if let Some(r) = highlight.r {
            of("R", three(r), "2 N (N·L) - L: the mirrored light, a unit vector, view space");
        }
        if let Some(h) = highlight.h {
            of("H", three(h), "halfway between L and V, a unit vector, view space");
        }
        of(symbol, digits(highlight.cosine), meaning);
        let meaning =
            "angle between the mirrored light and the viewer, or between N and H, degrees";
        of("Ω", degrees(highlight.cosine), meaning);
        of("lobe", digits(highlight.lobe), "that cosine to the power n, or the microfacets' lobe");
    }

    // List the terms that the light adds.
    of("ambient", three(t.ambient), "ambient term");
    of("diffuse", three(t.diffuse), "diffuse term");
    of("specular", three(t.specular), "specular term");
}

/// Three numbers, one after the other.
fn three(rgb: [f32; 3]) -> String {
    rgb.map(digits).join(" ")
}
