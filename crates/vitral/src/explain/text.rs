//! Explanations as text.

use super::{CornerNormal, Explanation, Gouraud, TracedRay};
use std::fmt;
use vitral_light::{Highlight, LightTerms};
use vitral_render::shading::pixel_light::{
    CoefficientValues, Evaluation, PixelLight, PointLight, ShadowOfLight,
};
use vitral_render::visible::fates::{ClipPlane, Fate};

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // List the facets whose outline holds the pixel, with the fate of each.
        let ([x, y], [r, g, b, a]) = (self.pixel, self.bytes);
        writeln!(f, "pixel {x},{y}: {r} {g} {b}, opacity {a}")?;
        writeln!(f, "{} facet(s) whose outline holds it:", self.candidates.len())?;
        for c in &self.candidates {
            let material = c.material.as_ref().map_or(String::new(), |m| format!(", material {m}"));
            let depth = c.candidate.depth.map_or("-".to_owned(), |depth| format!("{depth:.7}"));
            let (facet, surface, fate) = (c.candidate.facet, c.surface, fate(&c.candidate.fate));
            writeln!(
                f,
                "  depth {depth}  facet {facet} (surface {surface}, {}{material}): {fate}",
                c.mesh
            )?;
        }

        // Show how the pixel's light adds up.
        light(f, &self.light)?;
        if self.light.bytes != self.bytes {
            writeln!(
                f,
                "  with what mirrors, glass and translucent surfaces show: {r} {g} {b}, opacity {a}"
            )?;
        }

        // List the surfaces over the pixel's centre.
        writeln!(f, "{} surface(s) cover its centre, the nearest first", self.surfaces.len())?;
        for s in &self.surfaces {
            let material = s.material.as_ref().map_or(String::new(), |m| format!(", material {m}"));
            let layer = if s.layer { ", transparent" } else { "" };
            let (facet, surface) = (s.facet, s.surface);
            writeln!(
                f,
                "  depth {:.7}  facet {facet} (surface {surface}, {}{material}{layer})",
                s.depth, s.mesh
            )?;
        }

        // Show the interpolation of Gouraud shading.
        if let Some(gouraud) = &self.gouraud {
            self.normals.iter().try_for_each(|corner| write!(f, "{corner}"))?;
            write!(f, "{gouraud}")?;
        }

        // List the decision of each algorithm and its steps.
        for d in &self.decisions {
            match (&d.limit, d.facet, d.depth) {
                (Some(limit), ..) => writeln!(f, "{}: {limit}", d.algorithm)?,
                (None, Some(facet), Some(depth)) => {
                    writeln!(f, "{}: facet {facet} at depth {depth:.7}", d.algorithm)?
                }
                _ => writeln!(f, "{}: background", d.algorithm)?,
            }
            for step in &d.steps {
                writeln!(f, "  {step}")?;
            }
        }

        // List the rays.
        if !self.rays.is_empty() {
            writeln!(f, "ray tracing: {} ray(s)", self.rays.len())?;
        }
        self.rays.iter().try_for_each(|ray| write!(f, "{ray}"))
    }
}

/// What became of a facet, in words.
fn fate(fate: &Fate) -> String {
    let names =
        |planes: &[ClipPlane]| planes.iter().map(|p| p.name()).collect::<Vec<_>>().join(" and ");
    let list = |numbers: &[u32]| numbers.iter().map(u32::to_string).collect::<Vec<_>>().join(" ");
    match fate {
        Fate::NotDrawn => "not drawn, in a wireframe".to_owned(),
        Fate::BoxCulled { planes } if planes.is_empty() => {
            "culled, its box is outside of the view".to_owned()
        }
        Fate::BoxCulled { planes } => {
            format!("culled, its box is beyond the {} plane", names(planes))
        }
        Fate::OutsideFrustum { planes } => {
            format!("outside of the view, beyond the {} plane", names(planes))
        }
        Fate::NotFinite => "a corner is no finite number".to_owned(),
        Fate::Degenerate => "no area on the grid of 1/256 pixel".to_owned(),
        Fate::BackFace => "a back face, culled".to_owned(),
        Fate::ClippedAway { planes } => format!("clipped away here by the {} plane", names(planes)),
        Fate::BetweenSamples => "between the samples".to_owned(),
        Fate::Hidden { samples, by } => {
            format!("hidden at sample(s) {} by facet(s) {}", list(samples), list(by))
        }
        Fate::Layer { samples } => format!("seen through, a layer at sample(s) {}", list(samples)),
        Fate::Visible { samples } => format!("visible at sample(s) {}", list(samples)),
    }
}

/// A number with all digits of single precision.
fn one(number: f32) -> String {
    if number != 0.0 && number.abs() < 1e-4 { format!("{number:e}") } else { number.to_string() }
}

/// Numbers of a colour or a vector.
fn three(numbers: [f32; 3]) -> String {
    format!("({})", numbers.map(one).join(", "))
}

fn four(numbers: [f32; 4]) -> String {
    format!("({})", numbers.map(one).join(", "))
}

/// How the light of a pixel adds up.
fn light(f: &mut fmt::Formatter<'_>, light: &PixelLight) -> fmt::Result {
    writeln!(f, "light:")?;
    for (number, of_point) in light.points.iter().enumerate() {
        point(f, number, of_point)?;
    }
    for (number, sample) in light.samples.iter().enumerate() {
        let [x, y] = sample.at;
        let shows = sample.point.map_or("background".to_owned(), |p| format!("point {p}"));
        write!(f, "  sample {number} at {x},{y}: {shows} {}", four(sample.behind))?;
        for layer in &sample.layers {
            let of = layer.point.map_or("a line or dot".to_owned(), |p| format!("point {p}"));
            write!(
                f,
                "; in front {of} {}, lets {} through",
                four(layer.color),
                three(layer.passes)
            )?;
        }
        if sample.layers.is_empty() {
            writeln!(f)?
        } else {
            writeln!(f, "; together {}", four(sample.color))?
        }
    }
    let clamped = if light.clamped { ", clamped" } else { "" };
    writeln!(
        f,
        "  mean of the samples {}; colour {}{clamped}",
        four(light.average),
        three(light.straight)
    )?;
    let [r, g, b, a] = light.bytes;
    writeln!(f, "  encoded, times 255: {}; rounded: {r} {g} {b}, opacity {a}", four(light.encoded))
}

fn point(f: &mut fmt::Formatter<'_>, number: usize, p: &PointLight) -> fmt::Result {
    let ([x, y], [wx, wy, wz]) = (p.at, p.world);
    write!(f, "  point {number}: facet {} at {x},{y}, world ({wx:.5}, {wy:.5}, {wz:.5})", p.facet)?;
    writeln!(f, ", weights {}; {}, {} shading", three(p.weights), p.model, p.shading)?;
    for shadow in &p.shadows {
        writeln!(f, "    {}", of_shadow(shadow))?;
    }
    for e in &p.evaluations {
        evaluation(f, e)?;
    }
    writeln!(f, "    texture {}, with vertex colours {}", three(p.texture), three(p.base))?;
    writeln!(
        f,
        "    diffuse {}, specular {}, emission {}",
        three(p.diffuse),
        three(p.specular),
        three(p.emission)
    )?;
    if let Some(received) = p.interreflection {
        writeln!(f, "    from other surfaces {}", three(received))?;
    }
    if let Some(glow) = p.glow {
        writeln!(f, "    shines through {}", three(glow))?;
    }
    if let Some(cue) = p.depth_cue {
        writeln!(f, "    distance keeps {} of it and fades into {}", cue.kept, three(cue.into))?;
    }
    let times =
        if p.keeps_specular { "; specular light is multiplied with the coverage" } else { "" };
    writeln!(f, "    opacity {}, coverage {}{times}: colour {}", p.alpha, p.coverage, four(p.color))
}

fn of_shadow(s: &ShadowOfLight) -> String {
    let arrives = format!("light {}: S = {}", s.light, three(s.visibility));
    match (s.attached, s.blocker, s.distance) {
        (true, ..) => format!("{arrives}, the facet faces away"),
        (false, Some(facet), Some(distance)) => {
            format!("{arrives}, facet {facet} stands in the way at {distance:.5}")
        }
        _ => arrives,
    }
}

fn evaluation(f: &mut fmt::Formatter<'_>, e: &Evaluation) -> fmt::Result {
    if let Some(corner) = e.corner {
        writeln!(f, "    corner {corner}, weight {}:", e.weight)?;
    }
    writeln!(f, "    N = {}, V = {}, at {}", three(e.normal), three(e.viewer), three(e.position))?;
    match e.coefficients {
        CoefficientValues::Empirical { ka, kd, ks, shininess } => {
            writeln!(
                f,
                "    ka = {}, kd = {}, ks = {}, n = {shininess}",
                three(ka),
                three(kd),
                three(ks)
            )?;
        }
        CoefficientValues::Microfacet { base_color, metallic, roughness, occlusion } => {
            let base = three(base_color);
            writeln!(
                f,
                "    base {base}, metallic {metallic}, roughness {roughness}, occlusion {occlusion}"
            )?;
        }
    }
    writeln!(f, "    ambient light of the scene {}", three(e.ambient))?;
    for of_light in &e.lights {
        writeln!(f, "    light {}: {}", of_light.light, factors(&of_light.terms))?;
        let t = &of_light.terms;
        let (ambient, diffuse, specular) = (three(t.ambient), three(t.diffuse), three(t.specular));
        writeln!(f, "      ambient {ambient}, diffuse {diffuse}, specular {specular}")?;
    }
    if let Some(gathered) = e.gathered {
        writeln!(f, "    diffuse light of the surroundings {}", three(gathered))?;
    }
    if let Some(environment) = e.environment {
        let what = if e.gathered.is_some() { "surroundings" } else { "sky" };
        writeln!(f, "    mirrored {what} {}", three(environment))?;
    }
    writeln!(f, "    sum: diffuse {}, specular {}", three(e.diffuse), three(e.specular))
}

fn factors(t: &LightTerms) -> String {
    let mut text = format!("L = {}, N.L = {}", three(t.l), t.n_l);
    if let Some(distance) = t.distance {
        text += &format!(", distance {distance}, attenuation {}", t.attenuation);
    }
    if let Some(spot) = t.spot {
        text += &format!(", spot factor {spot}");
    }
    if let Some(emission) = t.emission {
        text += &format!(", cosine of emission {emission}");
    }
    if let Some(irradiance) = t.irradiance {
        text += &format!(", diffuse light of the whole shape {irradiance}");
    }
    let [ambient, diffuse, specular] = t.colors.map(three);
    text += &format!(", S = {}; colours {ambient} {diffuse} {specular}", three(t.visibility));
    let Some(Highlight { r, h, cosine, lobe, fresnel }) = t.highlight else { return text };
    text += &match (r, h) {
        (Some(r), _) => format!("; R = {}, R.V = {cosine}, to the power n {}", three(r), one(lobe)),
        (None, Some(h)) => format!("; H = {}, N.H = {cosine}, lobe {}", three(h), one(lobe)),
        (None, None) => String::new(),
    };
    if let Some(fresnel) = fresnel {
        text += &format!(", Fresnel {}", three(fresnel));
    }
    text
}

impl fmt::Display for TracedRay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let three = |[x, y, z]: [f64; 3]| format!("({x:.4}, {y:.4}, {z:.4})");
        let rgb = |color: [f32; 3]| three(color.map(f64::from));
        let (from, towards) = (three(self.origin), three(self.direction));
        write!(f, "  after {} turn(s), from {from} towards {towards}: ", self.turns)?;
        match &self.meets {
            Some(met) => {
                let material =
                    met.material.as_ref().map_or(String::new(), |m| format!(", material {m}"));
                let (facet, surface, distance) = (met.facet, met.surface, met.distance);
                write!(
                    f,
                    "facet {facet} (surface {surface}, {}{material}) at {distance:.4}",
                    met.mesh
                )?;
            }
            None => write!(f, "background")?,
        }
        writeln!(f, "; counts {}, adds {}", rgb(self.weight), rgb(self.light))?;
        for turn in &self.goes_on {
            let ([before, after], [n1, n2]) = (turn.angles_degrees, turn.indices);
            let bent = format!("at {before:.4} degrees in {n1}, goes on at {after:.4} in {n2}");
            let (direction, weight) = (three(turn.direction), rgb(turn.weight));
            writeln!(f, "    {} {bent}, towards {direction}; counts {weight}", turn.way.name())?;
        }
        Ok(())
    }
}

impl fmt::Display for CornerNormal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let vector = |[x, y, z]: [f32; 3]| format!("{x:.6} {y:.6} {z:.6}");
        let (result, mean) = (vector(self.result), vector(self.mean));
        writeln!(
            f,
            "normal at corner {} (vertex {}): {result}; mean of {} face(s): {mean}",
            self.corner,
            self.vertex,
            self.faces.len()
        )?;
        for face in &self.faces {
            let normal = vector(face.normal);
            writeln!(f, "  surface {}: {normal}, {:.1} degrees", face.surface, face.angle_degrees)?;
        }
        Ok(())
    }
}

impl fmt::Display for Gouraud {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rgb = |[r, g, b]: [f64; 3]| format!("{r:.6} {g:.6} {b:.6}");
        writeln!(f, "Gouraud shading of facet {}, on the screen:", self.facet)?;
        for (number, ([x, y], intensity)) in self.corners.iter().zip(self.intensities).enumerate() {
            writeln!(f, "  corner {number} at {x:.3},{y:.3}: I = {}", rgb(intensity))?;
        }
        for (side, edge) in ["left", "right"].iter().zip(&self.edges) {
            let [u, v] = edge.corners;
            let (py, at) = (rgb(edge.py), rgb(edge.intensity));
            writeln!(
                f,
                "  {side} edge from corner {u} to {v}: py = {py}; I = {at} at x = {:.3}",
                edge.x
            )?;
        }
        let (px, intensity, direct) = (rgb(self.px), rgb(self.intensity), rgb(self.direct));
        writeln!(
            f,
            "  span: px = {px}, added {} time(s): I = {intensity}; by weights {direct}",
            self.additions
        )
    }
}
