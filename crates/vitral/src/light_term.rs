//! One term of the lights alone: what the ambient, the diffuse or the specular part of all lights
//! adds to a picture.

use serde::{Deserialize, Serialize};
use vitral_light::Light;

/// A part of every light.
///
/// In raw colours without clamping the pictures of the three terms add up to the whole one, where
/// no surface shines by itself.
///
/// Source: the course, notes L, L5.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightTerm {
    /// Ambient light, the scene's too.
    Ambient,
    /// What surfaces scatter.
    Diffuse,
    /// Highlights.
    Specular,
}

impl LightTerm {
    /// All terms with their names.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Ambient, "ambient"), (Self::Diffuse, "diffuse"), (Self::Specular, "specular")];

    /// Takes the other parts from a light.
    pub(crate) fn keep(self, light: &mut Light) {
        let parts = [
            (Self::Ambient, &mut light.ambient),
            (Self::Diffuse, &mut light.diffuse),
            (Self::Specular, &mut light.specular),
        ];
        parts
            .into_iter()
            .filter(|(term, _)| *term != self)
            .for_each(|(_, color)| *color = [0.0; 3]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColorSpace, Renderer, load_builtin};

    #[test]
    fn l5_the_pictures_of_the_terms_add_up() {
        let mut renderer = Renderer::new(load_builtin("cubs").unwrap()).unwrap();
        (renderer.settings.picture.width, renderer.settings.picture.height) = (48, 36);
        renderer.settings.picture.color_space = ColorSpace::Raw;
        renderer.settings.picture.samples = 1;
        renderer.settings.picture.background = crate::Background::Color { color: [0.0; 3] };
        let mut pixels = |term: Option<LightTerm>| {
            renderer.light_term = term;
            renderer.render().unwrap().frame.color.unwrap().data().to_vec()
        };
        let whole = pixels(None);
        let terms = LightTerm::ALL.map(|(term, _)| pixels(Some(term)));
        assert!(terms.iter().all(|term| *term != whole));
        for (i, pixel) in whole.iter().enumerate() {
            for k in 0..3 {
                let sum: i32 = terms.iter().map(|term| i32::from(term[i][k])).sum();
                assert!((sum.min(255) - i32::from(pixel[k])).abs() <= 2, "{i}: {sum} {pixel:?}");
            }
        }
    }
}
