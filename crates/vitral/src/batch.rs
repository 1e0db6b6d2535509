//! Many pictures of one scene at once: each is made by one thread, with what is known of the scene
//! shared.
//!
//! One small picture leaves most threads idle, since its stages wait for each other. A batch gives
//! each thread pictures of its own.

use crate::{Camera, DMat4, Error, Global, Picture, Renderer};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Pictures to be made of one scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct Batch<'a> {
    /// The viewer of each picture; `None`: the renderer's, framed anew after instances were moved.
    pub cameras: &'a [Option<Camera>],
    /// Nodes that move from picture to picture.
    pub nodes: &'a [u32],
    /// The transform of each of these nodes to its parent, picture by picture: empty, or one for
    /// each camera and node.
    pub transforms: &'a [DMat4],
}

impl Batch<'_> {
    /// The moves before picture `i`.
    fn moves(&self, i: usize) -> Vec<(u32, DMat4)> {
        let count = self.nodes.len();
        let transforms = self.transforms.get(i * count..(i + 1) * count).unwrap_or(&[]);
        self.nodes.iter().copied().zip(transforms.iter().copied()).collect()
    }
}

impl Renderer {
    /// Renders the pictures of a batch, on all threads, and hands each to `take` with its number,
    /// in any order. They are those that [`place`](Self::place) and
    /// [`render_from`](Self::render_from) give one after the other, byte for byte. The scene is
    /// left as it was.
    ///
    /// # Errors
    /// As [`place`](Self::place) and [`render`](Self::render), and those of `take`: the error of
    /// the first picture that has one.
    ///
    /// # Panics
    /// If there are transforms, and not one for each camera and node.
    pub fn render_batch(
        &mut self,
        batch: &Batch<'_>,
        take: impl Fn(usize, &Renderer, &Camera, &Picture) -> Result<(), Error> + Sync,
    ) -> Result<(), Error> {
        let (count, moved) = (batch.cameras.len(), batch.transforms.len());
        assert!(
            moved == 0 || moved == count * batch.nodes.len(),
            "one transform for each camera and node is needed"
        );
        let nodes = &self.scene().nodes;
        let known = batch
            .nodes
            .iter()
            .filter_map(|&node| Some((node, nodes.get(node as usize)?.transform.matrix())));
        let home: Vec<(u32, DMat4)> = if moved == 0 { Vec::new() } else { known.collect() };

        // The first picture finds out what the others share.
        let one = |renderer: &mut Renderer, i: usize| -> Result<(), Error> {
            let moves = batch.moves(i);
            if !moves.is_empty() {
                renderer.place(&moves)?;
            }
            let camera = batch.cameras[i].unwrap_or_else(|| renderer.frame_camera());
            let picture = renderer.render_from(&camera)?;
            take(i, renderer, &camera, &picture)?;
            renderer.recycle(picture);
            Ok(())
        };
        // A solution of radiosity is found once, with all threads.
        let workers = self.execution().workers.clone();
        let threads =
            if self.settings.global.model == Global::Radiosity { 1 } else { workers.threads() };
        let alone = if threads < 2 || count < 3 { count } else { 1 };
        let mut result = (0..alone).try_for_each(|i| one(self, i));
        if result.is_ok() && alone < count {
            result = share(self, alone..count, |renderer, i| one(renderer, i));
        }

        // Bring the instances back.
        if !home.is_empty() {
            self.place(&home)?;
        }
        result
    }
}

/// Does the work of each number on the renderer's threads, each with a renderer of its own. Gives
/// the error of the lowest number: numbers are taken in order, and all below one that fails are
/// finished.
fn share(
    renderer: &Renderer,
    numbers: std::ops::Range<usize>,
    work: impl Fn(&mut Renderer, usize) -> Result<(), Error> + Sync,
) -> Result<(), Error> {
    let workers = &renderer.execution().workers;
    let forks: Vec<Renderer> =
        (0..workers.threads().min(numbers.len())).map(|_| renderer.fork()).collect();
    let (next, failed) = (AtomicUsize::new(numbers.start), AtomicBool::new(false));
    let first: Mutex<Option<(usize, Error)>> = Mutex::new(None);
    workers.for_each(forks, |mut fork| {
        while !failed.load(Ordering::Relaxed) {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= numbers.end {
                return;
            }
            if let Err(error) = work(&mut fork, i) {
                failed.store(true, Ordering::Relaxed);
                let mut first = first.lock().unwrap_or_else(PoisonError::into_inner);
                if first.as_ref().is_none_or(|(known, _)| i < *known) {
                    *first = Some((i, error));
                }
            }
        }
    });
    match first.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some((_, error)) => Err(error),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Shadows, Visibility, execution};
    use vitral_math::DVec3;

    /// Three figures, of which the last two move, from five sides.
    fn scene() -> (Renderer, Vec<Option<Camera>>, Vec<DMat4>) {
        let mut scene = crate::load_builtin("cubs").unwrap();
        scene.flatten().unwrap();
        let mut renderer = Renderer::with_execution(scene, execution(3)).unwrap();
        renderer.settings = renderer.settings.with_size(40, 30);
        let cameras = renderer.turntable_cameras(5).into_iter().map(Some).collect();
        let moves = (0..10)
            .map(|i| DMat4::from_rotation_y(f64::from(i) * 0.2) * DMat4::from_translation(DVec3::X))
            .collect();
        (renderer, cameras, moves)
    }

    #[test]
    fn a_batch_has_the_pictures_that_single_renders_have() {
        let (mut renderer, cameras, transforms) = scene();
        let nodes: Vec<u32> =
            renderer.world().instances.iter().rev().take(2).map(|i| i.node).collect();
        for (visibility, shadows) in [
            (Visibility::Z_BUFFER, Shadows::NONE),
            (Visibility::RAY_CAST, Shadows::RAY),
            (Visibility::BSP, Shadows::MAP),
            (Visibility::Z_BUFFER, Shadows::VOLUME),
        ] {
            renderer.settings.visibility = visibility;
            renderer.settings.shadows.algorithm = shadows;
            for transforms in [&[][..], &transforms] {
                // Each picture by a renderer of its own.
                let batch = Batch { cameras: &cameras, nodes: &nodes, transforms };
                let single = |i: usize| {
                    let mut fresh =
                        Renderer::with_execution(renderer.scene().as_ref().clone(), execution(1))
                            .unwrap();
                    fresh.settings = renderer.settings.clone();
                    fresh.place(&batch.moves(i)).unwrap();
                    fresh.render_from(&cameras[i].unwrap()).unwrap().rgba8().to_vec()
                };
                let expected: Vec<_> = (0..cameras.len()).map(single).collect();
                let before = renderer.render_from(&cameras[0].unwrap()).unwrap();
                let made = Mutex::new(vec![Vec::new(); cameras.len()]);
                renderer
                    .render_batch(&batch, |i, _, _, picture| {
                        made.lock().unwrap()[i] = picture.rgba8().to_vec();
                        Ok(())
                    })
                    .unwrap();
                assert_eq!(made.into_inner().unwrap(), expected, "{visibility} {shadows}");
                let after = renderer.render_from(&cameras[0].unwrap()).unwrap();
                assert_eq!(before.rgba8(), after.rgba8(), "the scene is as it was");
            }
        }
    }

    #[test]
    fn the_first_error_ends_a_batch() {
        let (mut renderer, cameras, _) = scene();
        let batch = Batch { cameras: &cameras, ..Batch::default() };
        let fail = |i: usize, _: &Renderer, _: &Camera, _: &Picture| {
            if i > 1 { Err(Error::usage(format!("picture {i}"), "")) } else { Ok(()) }
        };
        assert_eq!(renderer.render_batch(&batch, fail).unwrap_err().to_string(), "picture 2");
        let wrong = Batch { nodes: &[999], transforms: &[DMat4::IDENTITY; 5], ..batch };
        let error = renderer.render_batch(&wrong, |_, _, _, _| Ok(())).unwrap_err();
        assert!(error.to_string().contains("no node 999"), "{error}");
    }
}
