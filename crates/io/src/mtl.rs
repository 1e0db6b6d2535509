//! MTL, the material library of OBJ files.
//!
//! A library is a list of `newmtl NAME` blocks of statements. The illumination number (`illum`)
//! says which of them count: 0 is the constant colour `Kd` without light, 1 has no highlights, 2
//! and above have them (their reflections and refractions belong to ray tracing: from 3 to 7 the
//! surface is a mirror, in the proportion `Ks`; `Ni` bends light). Without `illum`, a `Ks` gives
//! highlights.
//!
//! What the format leaves open is chosen here: missing `Ka` is 0.2, `Kd` 0.8, `Ks` 0, `Ns` 10, `Ni`
//! 1; `Ns` below 1 counts as 1 (an exponent of 0 would paint the whole surface with its highlight);
//! colours are those of displays (sRGB), as the programs that write them show them. Opacity is `d`,
//! else `1 - Tr`, else, for the transparent models (`illum` 4, 6, 7, 9), `1 - mean(Tf)`, and the
//! filter is the hue of `Tf`; elsewhere `Tf` is ignored, as exporters write `Tf 1 1 1` into opaque
//! materials. `Tr 1` without `d` is opaque, with a warning: MeshLab means that by it, and nobody
//! wants a surface that is not seen.
//!
//! A material with `Pr` (roughness) or `Pm` (metal), or maps of them, is one of metallic-roughness
//! with the base colour `Kd`; missing values follow from `Ns` as Blender writes it,
//! `Ns = 1000 (1 - roughness)^2`, or is 0.5 and 0.
//!
//! Maps: `map_Kd` (shown alone: many programs leave the colour of their viewport in `Kd`, which is
//! kept as the tint; sRGB; its alpha, unless `map_d` is there, blends in a material that `d` makes
//! transparent and cuts out or blends in others), `map_Pr`, `map_Pm` (linear), `bump` or `map_Bump`
//! (a height map, or a normal map, which programs write there, too), `map_Ks` (linear), `map_Ke`
//! (sRGB), `map_d` (linear; the channel that `-imfchan` names, else alpha where the image has any,
//! else luminance) and `norm` (a normal map). Options stand before the name or behind it. Of them
//! `-s`, `-o`, `-clamp`, `-bm` (of bump maps) and `-imfchan` are obeyed; others, if they would
//! change the picture, are told. Texture coordinates of OBJ run upwards, ours run downwards from
//! the image's top: the loader turns `v` to `1 - v`, and so scale and offset along v become
//! `s v + 1 - s - o`.
//!
//! Source: \[MTL\].

use crate::Place;
use crate::text::{self, Cursor, is_blank, to_utf8};
use crate::textures::{Channel, Requests, Usage};
use crate::warnings::Warnings;
use vitral_frame::{Sampler, Wrap};
use vitral_light::{AlphaMode, Material, Reflectance, TextureRef};

/// A `newmtl` block, as in the file. `None`: not said.
#[derive(Clone, Debug, Default)]
pub(crate) struct MtlMaterial {
    pub(crate) name: String,
    ka: Option<[f32; 3]>,
    kd: Option<[f32; 3]>,
    ks: Option<[f32; 3]>,
    ke: Option<[f32; 3]>,
    tf: Option<[f32; 3]>,
    ns: Option<f32>,
    d: Option<f32>,
    tr: Option<f32>,
    ni: Option<f32>,
    illum: Option<i64>,
    map_kd: Option<Map>,
    map_ks: Option<Map>,
    map_ke: Option<Map>,
    map_d: Option<Map>,
    norm: Option<Map>,
    pr: Option<f32>,
    pm: Option<f32>,
    map_pr: Option<Map>,
    map_pm: Option<Map>,
    bump: Option<Map>,
}

/// A texture statement.
#[derive(Clone, Debug, PartialEq)]
struct Map {
    path: String,
    line: u64,
    scale: [f32; 2],
    offset: [f32; 2],
    clamp: bool,
    channel: Option<Channel>,
    /// The bump multiplier.
    strength: Option<f32>,
}

/// The least index of refraction that the format knows.
const LEAST_INDEX: f32 = 0.001;

/// Reads a library. Nothing in it is an error: what cannot be used is noted in `warnings`.
pub(crate) fn parse(bytes: &[u8], warnings: &mut Warnings) -> Vec<MtlMaterial> {
    let text = to_utf8(bytes);
    let mut cursor = Cursor::new(&text);
    let mut materials: Vec<MtlMaterial> = Vec::new();
    while cursor.next_content() {
        let place = Place::Line(cursor.line());
        let keyword = cursor.word();
        if keyword.eq_ignore_ascii_case(b"newmtl") {
            let name = text::name(cursor.rest_of_line()).into_owned();
            materials.push(MtlMaterial { name, ..MtlMaterial::default() });
        } else if let Some(material) = materials.last_mut() {
            material.statement(keyword, &mut cursor, warnings);
        } else {
            warnings
                .note("before newmtl", place, || format!("`{}` before any newmtl", show(keyword)));
        }
        if cursor.take_ill_formed() {
            warnings.note("number", Place::Line(cursor.line()), || {
                "ill-formed number; its beginning is used".into()
            });
        }
        cursor.next_line();
    }
    tell_of_reversed(&materials, warnings);
    materials
}

/// Names the materials whose `Tr 1` is not obeyed, the first few of them.
fn tell_of_reversed(materials: &[MtlMaterial], warnings: &mut Warnings) {
    const NAMED: usize = 4;
    let names: Vec<&str> =
        materials.iter().filter(|m| m.is_reversed()).map(|m| m.name.as_str()).collect();
    if names.is_empty() {
        return;
    }
    warnings.note("reversed Tr", Place::File, || {
        let more = names.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let list =
            names.iter().take(NAMED).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        format!("`Tr 1` without `d` would be invisible, it is taken for opaque: {list}{more}")
    });
}

fn show(word: &[u8]) -> String {
    String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned()
}

impl MtlMaterial {
    fn statement(&mut self, keyword: &[u8], cursor: &mut Cursor, warnings: &mut Warnings) {
        let line = cursor.line();
        match keyword.to_ascii_lowercase().as_slice() {
            // Colours and numbers keep their value if the statement is bad.
            b"ka" => self.ka = color(cursor, warnings).or(self.ka),
            b"kd" => self.kd = color(cursor, warnings).or(self.kd),
            b"ks" => self.ks = color(cursor, warnings).or(self.ks),
            b"ke" => self.ke = color(cursor, warnings).or(self.ke),
            b"tf" => self.tf = color(cursor, warnings).or(self.tf),
            b"ns" => self.ns = number(cursor, warnings).or(self.ns),
            b"d" => {
                self.d =
                    dissolve(cursor, warnings).map(|d| share(d, "d", line, warnings)).or(self.d)
            }
            b"tr" => {
                self.tr =
                    number(cursor, warnings).map(|t| share(t, "Tr", line, warnings)).or(self.tr)
            }
            b"ni" => {
                self.ni =
                    number(cursor, warnings).and_then(|n| index(n, line, warnings)).or(self.ni)
            }
            b"illum" => {
                self.illum = cursor.integer().filter(|i| (0..=10).contains(i)).or_else(|| {
                    warnings.note("illum", Place::Line(line), || {
                        "illum must be 0 to 10; ignored".into()
                    });
                    self.illum
                })
            }
            b"map_kd" => self.map_kd = map(cursor, warnings),
            b"map_ks" => self.map_ks = map(cursor, warnings),
            b"map_ke" => self.map_ke = map(cursor, warnings),
            b"map_d" => self.map_d = map(cursor, warnings),
            b"norm" => self.norm = map(cursor, warnings),
            b"pr" => {
                self.pr =
                    number(cursor, warnings).map(|r| share(r, "Pr", line, warnings)).or(self.pr)
            }
            b"pm" => {
                self.pm =
                    number(cursor, warnings).map(|m| share(m, "Pm", line, warnings)).or(self.pm)
            }
            b"map_pr" => self.map_pr = map(cursor, warnings),
            b"map_pm" => self.map_pm = map(cursor, warnings),
            b"bump" | b"map_bump" => self.bump = map(cursor, warnings).or(self.bump.take()),
            // What changes nothing is no loss.
            b"pc" | b"pcr" | b"ps" | b"aniso" | b"anisor"
                if cursor.word_at(cursor.offset()).iter().all(|b| matches!(b, b'0' | b'.')) => {}
            // The ambient map follows the diffuse one; only another image would make a difference.
            b"map_ka" => {
                let ambient = map(cursor, warnings).map(|m| m.path);
                if self.map_kd.as_ref().is_some_and(|m| Some(&m.path) != ambient.as_ref()) {
                    warnings.note("map_Ka", Place::Line(line), || {
                        "map_Ka is not used: ambient light takes map_Kd".into()
                    });
                }
            }
            b"pc" | b"pcr" => {
                let what = || format!("`{}` is not used: clear coats are not shown", show(keyword));
                warnings.note("mtl coat", Place::Line(line), what);
            }
            // Warn of statements that are known and not used, and of unknown ones.
            b"disp" | b"map_disp" | b"decal" | b"map_ns" | b"map_tr" | b"map_ni" | b"refl"
            | b"map_refl" | b"map_aat" | b"sharpness" | b"ps" | b"aniso" | b"anisor"
            | b"map_ps" => {
                warnings.note("mtl unused", Place::Line(line), || {
                    format!("`{}` is not used", show(keyword))
                });
            }
            _ => warnings.note("mtl unknown", Place::Line(line), || {
                format!("unknown statement `{}`", show(keyword))
            }),
        }
    }

    /// The material, in vitral's terms. Its texture indices count `requests`.
    pub(crate) fn build(&self, library: &str, requests: &mut Requests) -> Material {
        let lit = self.illum != Some(0);
        let shiny = self.illum.is_none_or(|i| i >= 2);
        let map_ks = self.map_ks.as_ref().filter(|_| shiny);
        let ks = if shiny {
            self.ks.unwrap_or(if map_ks.is_some() { [1.0; 3] } else { [0.0; 3] })
        } else {
            [0.0; 3]
        };
        let (opacity, filter) = (self.opacity(), self.filter());
        let is_metallic_roughness = self.has_roughness();
        let is_transparent = opacity < 1.0 || self.map_d.is_some();

        // With a map of its own for opacity, the diffuse map's alpha must not count a second time.
        let kd_usage = if self.map_d.is_some() { Usage::OpaqueColor } else { Usage::Color };
        let mut texture = |map: &Option<Map>, usage: Usage| {
            map.as_ref().map(|m| TextureRef {
                transform: m.transform(),
                sampler: m.sampler(),
                ..TextureRef::new(requests.add(library, m.line, &m.path, usage))
            })
        };

        // Find the normal map; a bump map takes its place.
        let normal_texture = match (&self.norm, &self.bump) {
            (None, Some(_)) => texture(&self.bump, Usage::Bump),
            _ => texture(&self.norm, Usage::Data),
        };
        let normal_scale =
            self.norm.as_ref().or(self.bump.as_ref()).and_then(|m| m.strength).unwrap_or(1.0);
        let opacity_usage =
            Usage::Grey(self.map_d.as_ref().and_then(|m| m.channel).unwrap_or(Channel::Matte));
        Material {
            name: self.name.clone(),
            reflectance: if is_metallic_roughness {
                self.metallic_roughness()
            } else {
                self.phong(ks)
            },
            srgb_colors: true,
            texture_tint: self.kd.filter(|kd| self.map_kd.is_some() && *kd != [1.0; 3]),
            emission: self.ke.unwrap_or(if self.map_ke.is_some() { [1.0; 3] } else { [0.0; 3] }),
            opacity,
            filter,
            alpha_mode: if is_transparent { AlphaMode::Blend } else { AlphaMode::Opaque },
            ior: self
                .ni
                .filter(|ni| !is_metallic_roughness || *ni > 1.0)
                .unwrap_or(if is_metallic_roughness { 1.5 } else { 1.0 }),
            // The models with ray-traced reflection.
            mirror: matches!(self.illum, Some(3..=7)),
            unlit: !lit,
            base_texture: texture(&self.map_kd, kd_usage),
            specular_texture: texture(&map_ks.cloned(), Usage::Data),
            emission_texture: texture(&self.map_ke, Usage::Color),
            opacity_texture: texture(&self.map_d, opacity_usage),
            metallic_roughness_texture: self.roughness_texture(library, requests),
            normal_texture,
            normal_scale,
            ..Material::default()
        }
    }

    /// Whether the material is one of metallic-roughness.
    fn has_roughness(&self) -> bool {
        self.pr.is_some() || self.pm.is_some() || self.map_pr.is_some() || self.map_pm.is_some()
    }

    fn diffuse(&self) -> [f32; 3] {
        if self.map_kd.is_some() { [1.0; 3] } else { self.kd.unwrap_or([0.8; 3]) }
    }

    fn phong(&self, ks: [f32; 3]) -> Reflectance {
        let (ka, shininess) = (self.ka.unwrap_or([0.2; 3]), self.ns.unwrap_or(10.0).max(1.0));
        Reflectance::Phong { ka, kd: self.diffuse(), ks, shininess }
    }

    fn metallic_roughness(&self) -> Reflectance {
        // A map multiplies; without a factor it counts as it is.
        let from_shininess = self.ns.map(|ns| 1.0 - (ns.clamp(0.0, 1000.0) / 1000.0).sqrt());
        let roughness = if self.map_pr.is_some() { 1.0 } else { from_shininess.unwrap_or(0.5) };
        let metallic = if self.map_pm.is_some() { 1.0 } else { 0.0 };
        Reflectance::MetallicRoughness {
            base_color: self.diffuse(),
            metallic: self.pm.filter(|_| self.map_pm.is_none()).unwrap_or(metallic),
            roughness: self.pr.filter(|_| self.map_pr.is_none()).unwrap_or(roughness),
        }
    }

    /// The maps of roughness and metal as one texture, placed as the first of them.
    fn roughness_texture(&self, library: &str, requests: &mut Requests) -> Option<TextureRef> {
        let mut image =
            |map: &Option<Map>| map.as_ref().map(|m| requests.image(library, m.line, &m.path));
        let images = [image(&self.map_pr), image(&self.map_pm)];
        let map = self.map_pr.as_ref().or(self.map_pm.as_ref())?;
        let number = requests.add_metallic_roughness(images);
        Some(TextureRef {
            transform: map.transform(),
            sampler: map.sampler(),
            ..TextureRef::new(number)
        })
    }

    /// The colour of what passes, apart from how much: `kt` times it is `Tf` where `Tf` gives both.
    fn filter(&self) -> [f32; 3] {
        let Some(tf) = self.tf.filter(|_| matches!(self.illum, Some(4 | 6 | 7 | 9))) else {
            return [1.0; 3];
        };
        let tf = tf.map(|c| c.clamp(0.0, 1.0));
        let whole = match (self.d, self.tr) {
            (None, None) => (tf[0] + tf[1] + tf[2]) / 3.0,
            _ => tf[0].max(tf[1]).max(tf[2]),
        };
        if whole > 0.0 { tf.map(|c| c / whole) } else { [1.0; 3] }
    }

    /// Whether the material would be invisible by `Tr` alone, which some exporters write for opaque
    /// ones.
    fn is_reversed(&self) -> bool {
        self.d.is_none() && self.tr == Some(1.0)
    }

    fn opacity(&self) -> f32 {
        if self.is_reversed() {
            return 1.0;
        }
        let filtered = matches!(self.illum, Some(4 | 6 | 7 | 9));
        let from_filter =
            self.tf.filter(|_| filtered).map(|tf| 1.0 - (tf[0] + tf[1] + tf[2]) / 3.0);
        self.d.or(self.tr.map(|t| 1.0 - t)).or(from_filter).unwrap_or(1.0).clamp(0.0, 1.0)
    }
}

impl Map {
    fn transform(&self) -> [[f32; 3]; 2] {
        let ([su, sv], [ou, ov]) = (self.scale, self.offset);
        [[su, 0.0, ou], [0.0, sv, 1.0 - sv - ov]]
    }

    fn sampler(&self) -> Sampler {
        let wrap = if self.clamp { Wrap::ClampToEdge } else { Wrap::Repeat };
        Sampler { wrap_s: wrap, wrap_t: wrap, ..Sampler::default() }
    }
}

/// One number or three; `spectral` and `xyz` colours are not read.
fn color(cursor: &mut Cursor, warnings: &mut Warnings) -> Option<[f32; 3]> {
    let red = number(cursor, warnings)?;
    if cursor.at_line_end() {
        return Some([red; 3]);
    }
    let (green, blue) = (
        number(cursor, warnings)?,
        if cursor.at_line_end() { None } else { number(cursor, warnings) },
    );
    Some([red, green, blue.unwrap_or(green)])
}

fn number(cursor: &mut Cursor, warnings: &mut Warnings) -> Option<f32> {
    let line = cursor.line();
    let value = cursor.float().filter(|v| v.is_finite());
    if value.is_none() {
        let word = show(cursor.word());
        warnings.note("mtl number", Place::Line(line), || {
            format!("`{word}` is not a number; the statement is ignored")
        });
    }
    value
}

/// A number from 0 to 1; what is outside is moved to the nearer end.
fn share(value: f32, keyword: &str, line: u64, warnings: &mut Warnings) -> f32 {
    let inside = value.clamp(0.0, 1.0);
    if inside != value {
        warnings.note("mtl share", Place::Line(line), || {
            format!("`{keyword} {value}`: 0 to 1 is possible; {inside} is used")
        });
    }
    inside
}

/// An index of refraction, above 0.
fn index(value: f32, line: u64, warnings: &mut Warnings) -> Option<f32> {
    if value < LEAST_INDEX {
        warnings.note("mtl index", Place::Line(line), || {
            format!("`Ni {value}`: an index of refraction is {LEAST_INDEX} or more; the statement is ignored")
        });
        return None;
    }
    Some(value)
}

fn dissolve(cursor: &mut Cursor, warnings: &mut Warnings) -> Option<f32> {
    let mut ahead = *cursor;
    if ahead.word() == b"-halo" {
        *cursor = ahead;
        warnings.note("halo", Place::Line(cursor.line()), || {
            "`-halo` is not used: opacity is even".into()
        });
    }
    number(cursor, warnings)
}

/// The name of a file as resolvers take it: without quotes, blanks without the `\` that some
/// writers put before them, and `/` between folders.
pub(crate) fn file_name(text: &str) -> String {
    text.trim_matches('"').replace("\\ ", " ").replace('\\', "/")
}

/// A texture statement: options, a file name that may hold blanks, and options that belong before
/// it.
fn map(cursor: &mut Cursor, warnings: &mut Warnings) -> Option<Map> {
    let line = cursor.line();
    let mut map = Map {
        path: String::new(),
        line,
        scale: [1.0; 2],
        offset: [0.0; 2],
        clamp: false,
        channel: None,
        strength: None,
    };
    map.options(cursor, warnings);
    let rest = cursor.rest_of_line();
    let name =
        map.options_behind(rest, line, warnings).map_or(rest, |end| rest[..end].trim_ascii_end());
    map.path = file_name(&text::name(name));
    if map.path.is_empty() {
        warnings
            .note("map name", Place::Line(line), || "texture statement without a file name".into());
        return None;
    }
    Some(map)
}

impl Map {
    /// Reads all options from the cursor on.
    fn options(&mut self, cursor: &mut Cursor, warnings: &mut Warnings) {
        loop {
            let mut ahead = *cursor;
            let option = ahead.word();
            let known = option.first() == Some(&b'-')
                && self.option(&option.to_ascii_lowercase(), &mut ahead, warnings);
            if !known {
                return;
            }
            *cursor = ahead;
        }
    }

    /// Reads options behind the name of a file, and tells where they begin: behind a word with an
    /// extension, if nothing else follows. A name may hold anything that looks like an option
    /// otherwise.
    fn options_behind(&mut self, rest: &[u8], line: u64, warnings: &mut Warnings) -> Option<usize> {
        let begins =
            |&k: &usize| rest[k] == b'-' && is_blank(rest[k - 1]) && rest[..k].contains(&b'.');
        let start = (1..rest.len()).find(begins)?;
        let (mut with_options, mut own) = (self.clone(), Warnings::default());
        // A word in place of the name ends them.
        let text = [&rest[start..], b" /"].concat();
        let mut cursor = Cursor::at_line(&text, line);
        with_options.options(&mut cursor, &mut own);
        if cursor.word() != b"/" || !cursor.at_line_end() {
            return None;
        }
        *self = with_options;
        warnings.append(own, 0);
        Some(start)
    }

    /// Reads an option's values; false if there is no such option.
    fn option(&mut self, option: &[u8], cursor: &mut Cursor, warnings: &mut Warnings) -> bool {
        let place = Place::Line(cursor.line());
        let mut unused = |changes: bool| {
            if changes {
                let name = show(option);
                warnings.note("map option", place.clone(), || {
                    format!("texture option `{name}` is not used")
                });
            }
        };
        match option {
            b"-s" => self.scale = two(cursor, [1.0; 2]),
            b"-o" => self.offset = two(cursor, [0.0; 2]),
            b"-t" => unused(two(cursor, [0.0; 2]) != [0.0; 2]),
            b"-mm" => unused(two(cursor, [0.0, 1.0]) != [0.0, 1.0]),
            b"-clamp" => self.clamp = cursor.word().eq_ignore_ascii_case(b"on"),
            b"-imfchan" => {
                let name = cursor.word();
                self.channel = Channel::from_letter(name);
                unused(self.channel.is_none());
            }
            b"-blendu" | b"-blendv" => unused(!cursor.word().eq_ignore_ascii_case(b"on")),
            b"-cc" => unused(cursor.word().eq_ignore_ascii_case(b"on")),
            b"-bm" => self.strength = cursor.float().filter(|b| b.is_finite()).or(self.strength),
            b"-boost" => unused(cursor.float().is_some_and(|b| b != 0.0)),
            b"-texres" => unused(cursor.float().is_some()),
            b"-type" | b"-colorspace" => unused(!cursor.word().is_empty()),
            _ => return false,
        }
        true
    }
}

/// One to three numbers, of which the first two count.
fn two(cursor: &mut Cursor, mut values: [f32; 2]) -> [f32; 2] {
    for k in 0..3 {
        let mut ahead = *cursor;
        let Some(value) = ahead.float() else { break };
        // A file name may begin with a digit: `2nd wall.png` is no number.
        if ahead.take_ill_formed() || ahead.at_line_end() {
            break;
        }
        *cursor = ahead;
        if k < 2 && value.is_finite() {
            values[k] = value;
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(text: &str) -> (Material, Requests, Vec<String>) {
        let (mut warnings, mut requests) = (Warnings::default(), Requests::default());
        let parsed = parse(text.as_bytes(), &mut warnings);
        let material = parsed[0].build("m.mtl", &mut requests);
        (material, requests, warnings.into_messages("m.mtl"))
    }

    #[test]
    fn every_coefficient_arrives() {
        let (m, _, warnings) = one(
            "newmtl a b \r\nKa .1 .2 .3\r\nKd 0.5\r\nKs 1 1 1\r\nNs 250\r\nKe 0 1 0\r\nd 0.25\r\nNi 1.33\r\nillum 2\r\n",
        );
        assert_eq!(m.name, "a b");
        assert_eq!(
            m.reflectance,
            Reflectance::Phong {
                ka: [0.1, 0.2, 0.3],
                kd: [0.5; 3],
                ks: [1.0; 3],
                shininess: 250.0
            }
        );
        assert_eq!(
            (m.emission, m.opacity, m.ior, m.alpha_mode),
            ([0.0, 1.0, 0.0], 0.25, 1.33, AlphaMode::Blend)
        );
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn illumination_numbers_choose_the_formula() {
        assert!(one("newmtl a\nillum 0").0.unlit);
        let ks = |text: &str| match one(text).0.reflectance {
            Reflectance::Phong { ks, .. } => ks,
            other => panic!("{other:?}"),
        };
        assert_eq!(ks("newmtl a\nKs 1 1 1\nillum 1"), [0.0; 3]);
        assert_eq!(ks("newmtl a\nKs .5 .5 .5"), [0.5; 3]);
        assert_eq!(one("newmtl a\nTf 1 1 1\nillum 2").0.opacity, 1.0);
        assert_eq!(one("newmtl a\nTf .5 .5 .5\nillum 4").0.opacity, 0.5);
        assert_eq!(one("newmtl a\nTr .75").0.opacity, 0.25);
    }

    #[test]
    fn a_surface_that_tr_alone_makes_invisible_is_opaque() {
        let (m, _, warnings) =
            one("newmtl a\nTr 1.000000\nnewmtl b\nTr 1\nd 0\nnewmtl c\nTr 1\nnewmtl d\nTr .99");
        assert_eq!((m.opacity, m.alpha_mode), (1.0, AlphaMode::Opaque));
        assert_eq!(
            warnings,
            ["m.mtl: `Tr 1` without `d` would be invisible, it is taken for opaque: `a`, `c`"]
        );
        let (m, _, warnings) = one("newmtl a\nd 0\nTr 1");
        assert_eq!((m.opacity, warnings.len()), (0.0, 0), "`d` says so, too");
        let many: String = (0..6).map(|k| format!("newmtl m{k}\nTr 1\n")).collect();
        assert!(one(&many).2[0].ends_with(": `m0`, `m1`, `m2`, `m3` and 2 more"));
    }

    #[test]
    fn what_is_out_of_range_is_told() {
        let (m, _, warnings) = one("newmtl a\nd 1.5\nNi -2\n");
        assert_eq!((m.opacity, m.ior), (1.0, 1.0));
        assert!(warnings[0].contains("`d 1.5`: 0 to 1 is possible; 1 is used"), "{warnings:?}");
        assert!(
            warnings[1].contains("`Ni -2`: an index of refraction is 0.001 or more"),
            "{warnings:?}"
        );
        let (m, _, warnings) = one("newmtl a\nTr -0.5\nNi 1.2\nNi 0\n");
        assert_eq!((m.opacity, m.ior, warnings.len()), (1.0, 1.2, 2));
        assert_eq!(one("newmtl a\nTf .5 .5 .5\nillum 2").0.filter, [1.0; 3]);
        assert_eq!(
            one("newmtl a\nTf 0 .375 .375\nillum 4").0.filter,
            [0.0, 1.5, 1.5],
            "kt is 0.25"
        );
        assert_eq!(one("newmtl a\nTf 0 .5 .25\nd .4\nillum 4").0.filter, [0.0, 1.0, 0.5]);
        assert_eq!(one("newmtl a\nTf 0 0 0\nillum 4").0.filter, [1.0; 3]);
    }

    #[test]
    fn names_of_maps_begin_behind_all_options() {
        let (_, requests, warnings) =
            one("newmtl m\nmap_Kd -colorspace sRGB -o 0.5 0 a\\ b.png\nmap_Ks textures\\c.png");
        assert_eq!(requests.paths(), ["a b.png", "textures/c.png"]);
        assert_eq!(warnings, ["m.mtl: line 2: texture option `-colorspace` is not used"]);
    }

    #[test]
    fn map_options_turn_with_v() {
        let (m, requests, warnings) = one(
            "newmtl a\nmap_Kd -s 2 3 1 -o .5 .25 -clamp on -mm 0 1 .\\my wood 1.png\nmap_d -imfchan r x.png\ndecal b.png",
        );
        let base = m.base_texture.unwrap();
        assert_eq!(base.transform, [[2.0, 0.0, 0.5], [0.0, 3.0, -2.25]]);
        assert_eq!(base.sampler.wrap_s, Wrap::ClampToEdge);
        assert_eq!(requests.paths(), ["./my wood 1.png", "x.png"]);
        assert_eq!(warnings, ["m.mtl: line 4: `decal` is not used"]);
        assert_eq!(one("newmtl a\nmap_Kd -s 1 2 2nd.png").1.paths(), ["2nd.png"]);
        assert_eq!(one("newmtl a\nmap_Kd -strange.png").1.paths(), ["-strange.png"]);
    }

    #[test]
    fn options_may_stand_behind_the_name() {
        let (m, requests, warnings) =
            one("newmtl a\nmap_Kd my t.png -clamp on -s 2 3\nmap_Ks a -b.png\nmap_Ke b.png -o x");
        let base = m.base_texture.unwrap();
        assert_eq!(
            (base.sampler.wrap_s, base.transform),
            (Wrap::ClampToEdge, [[2.0, 0.0, 0.0], [0.0, 3.0, -2.0]])
        );
        assert_eq!(
            (requests.paths(), warnings.len()),
            (vec!["my t.png", "a -b.png", "b.png -o x"], 0)
        );
    }

    #[test]
    fn roughness_and_metal_make_the_other_form() {
        let form = |text: &str| one(text).0.reflectance;
        let expected = |metallic, roughness| Reflectance::MetallicRoughness {
            base_color: [0.5; 3],
            metallic,
            roughness,
        };
        assert_eq!(form("newmtl a\nKd .5\nPr 0.25\nPm 1"), expected(1.0, 0.25));
        assert_eq!(form("newmtl a\nKd .5\nNs 250\nPm 1"), expected(1.0, 0.5));
        assert_eq!(form("newmtl a\nKd .5\nPm 0"), expected(0.0, 0.5));
        let (m, requests, warnings) = one(
            "newmtl a\nKd .5\nPr .1\nmap_Pr r.png\nmap_Pm -s 2 2 m.png\nmap_Bump -bm 0.5 n.png\nPc 0.0\nNi 1.0\naniso 0",
        );
        assert_eq!((m.reflectance, m.ior), (expected(1.0, 1.0), 1.5));
        assert_eq!((m.normal_scale, warnings.len()), (0.5, 0), "{warnings:?}");
        assert!(m.normal_texture.is_some() && m.metallic_roughness_texture.is_some());
        assert_eq!(requests.paths().len(), 3);
        assert_eq!(
            one("newmtl a\nPc 0.5").2,
            ["m.mtl: line 2: `Pc` is not used: clear coats are not shown"]
        );
        assert!(one("newmtl a\nbump b.png\nnorm n.png").1.paths() == ["n.png"]);
    }

    #[test]
    fn maps_without_a_coefficient_show_as_they_are() {
        let kd = |text: &str| match one(text).0.reflectance {
            Reflectance::Phong { kd, ks, .. } => (kd, ks),
            other => panic!("{other:?}"),
        };
        assert_eq!(kd("newmtl a\nmap_Kd a.png"), ([1.0; 3], [0.0; 3]));
        assert_eq!(kd("newmtl a\nmap_Kd a.png\nmap_Ks b.png"), ([1.0; 3], [1.0; 3]));
        // A colour beside a texture is kept apart.
        assert_eq!(kd("newmtl a\nKd .5 .5 .5\nmap_Kd a.png").0, [1.0; 3]);
        assert_eq!(one("newmtl a\nKd .5 .5 .5\nmap_Kd a.png").0.texture_tint, Some([0.5; 3]));
        assert_eq!(one("newmtl a\nKd 1 1 1\nmap_Kd a.png").0.texture_tint, None);
        assert_eq!(kd("newmtl a").0, [0.8; 3]);
        assert_eq!(one("newmtl a\nmap_Ke a.png").0.emission, [1.0; 3]);
    }

    #[test]
    fn nonsense_is_told_and_passed_over() {
        let (m, _, warnings) = one("Kd 1 1 1\nnewmtl a\nKd red\nillum 99\nfoo\nmap_Kd\nKa nan 1 1");
        assert!(m.base_texture.is_none());
        assert_eq!(warnings.len(), 5, "{warnings:?}");
        assert!(warnings[1].contains("line 3: `red` is not a number"));
    }
}
