//! A map for the tests of this folder.

use super::draw::{FirstPass, When};
use super::lens::Lens;
use super::tiles::Map;
use crate::shadow::occluders::Occluders;
use crate::{Execution, Session, Settings};
use std::sync::Arc;
use vitral_light::AlphaMode;
use vitral_math::{Aabb, DVec3};
use vitral_scene::builtin;

/// What parallel light sees of a teapot, one that lets half of it through if `transparent`, and the
/// box of that.
pub(super) fn teapot(transparent: bool, towards: DVec3, size: u32, when: When) -> (Map, Aabb) {
    let mut scene = builtin::scene("teapot").expect("there is one");
    if transparent {
        scene.materials[0].alpha_mode = AlphaMode::Blend;
        scene.materials[0].opacity = 0.5;
    }
    let session = Session::new(Arc::new(scene)).expect("a sound scene");
    let (settings, execution) = (Settings::default(), Execution::default());
    let occluders = Occluders::new(&session, &settings);
    let lens = Lens::parallel(towards, &session.world, size);
    let pass = FirstPass {
        session: &session,
        occluders: &occluders,
        settings: &settings,
        execution: &execution,
        when,
    };
    let map = pass.draw(lens).expect("no limit");
    (map, session.world.bounds)
}
