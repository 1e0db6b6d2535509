//! One image of a texture: its texels, and the planes that it turns into when a framebuffer object
//! draws to it.
//!
//! Texels are an immutable [`Level`] that textures in pending draws share; they are copied when
//! they change. Once a layer is attached its colours live in a [`ColorPlane`]; texels are made from
//! it again when someone looks after a draw. Depths of an attached level stay in their plane: the
//! sampler reads it.

use super::internal_format::{InternalFormat, Storage};
use super::s3tc::Blocks;
use super::store::MAX_IMAGE_BYTES;
use super::texels::{self, TexelData, color_from_word, stored_depth};
use crate::memory::{LARGE, can_have};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use vitral_raster::Viewport;
use vitral_raster::forward::{ColorPlane, DepthBuffer, Level, Plane, StencilPlane, Texels};

/// A plane that passes and images share.
pub(crate) type Shared<T> = Arc<Mutex<T>>;

/// Locks; a panic elsewhere does not matter to samples.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A new plane for colours of `format`, as a framebuffer stores them.
pub(crate) fn new_color_plane(
    format: &InternalFormat,
    viewport: Viewport,
    samples: usize,
) -> ColorPlane {
    match format.storage {
        Storage::Unorm8 | Storage::Srgb8 => {
            ColorPlane::Rgba8(Plane::new(viewport, samples, format.kept_word(0)))
        }
        _ => ColorPlane::RgbaF32(Plane::new(viewport, samples, format.kept([0.0; 4]))),
    }
}

/// One level of one face.
#[derive(Debug)]
pub(crate) struct TextureImage {
    /// The format of the stored texels.
    pub format: InternalFormat,
    /// Width, height, depth, with borders.
    pub size: [u32; 3],
    /// 0 or 1.
    pub border: u32,
    /// `None`: nothing was ever put there.
    level: Option<Arc<Level>>,
    /// Colours of the layers that were attached.
    colors: Vec<Option<Shared<ColorPlane>>>,
    /// Stencil values of `DEPTH_STENCIL` images.
    stencil: Option<Shared<StencilPlane>>,
    /// Grows when something may draw to `colors`.
    writes: Arc<AtomicU64>,
    /// `writes` when `level` was last made from `colors`.
    synced: u64,
    /// The blocks that the texels were given as, as long as they are the same.
    pub blocks: Option<Blocks>,
}

impl TextureImage {
    /// An image without defined texels.
    pub(crate) fn new(format: InternalFormat, size: [u32; 3], border: u32) -> Self {
        Self {
            format,
            size,
            border,
            level: None,
            colors: Vec::new(),
            stencil: None,
            writes: Arc::default(),
            synced: 0,
            blocks: None,
        }
    }

    /// Size as `usize`.
    pub(crate) fn full(&self) -> [usize; 3] {
        self.size.map(|s| s as usize)
    }

    fn texel_count(&self) -> usize {
        self.full().iter().product()
    }

    /// Whether an image is no larger than images may be.
    pub(crate) fn fits(format: &InternalFormat, size: [u32; 3]) -> bool {
        let bytes = size.iter().try_fold(format.texel_bytes(), |n, &s| n.checked_mul(s as usize));
        bytes.is_some_and(|n| n <= MAX_IMAGE_BYTES)
    }

    /// Takes the memory of a large image's texels, which are all 0; whether it could be had. That
    /// of small ones, and of what framebuffers draw depths to, comes when it is needed.
    pub(crate) fn allocate(&mut self) -> bool {
        if self.bytes() < LARGE || !self.format.is_color() {
            return true;
        }
        let there = can_have(self.bytes());
        if there {
            self.level = Some(self.blank_level());
        }
        there
    }

    /// Size of its texels in memory.
    pub(crate) fn bytes(&self) -> usize {
        self.texel_count() * self.format.texel_bytes()
    }

    /// Size of the copy that a change of its texels makes, since something else has them.
    pub(crate) fn copied_bytes(&self) -> usize {
        let shared = self.level.as_ref().is_some_and(|level| Arc::strong_count(level) > 1);
        if shared { self.bytes() } else { 0 }
    }

    fn viewport(&self) -> Option<Viewport> {
        Viewport::new(self.size[0], self.size[1])
    }

    /// The counter of draws to this image.
    pub(crate) fn writes(&self) -> Arc<AtomicU64> {
        self.writes.clone()
    }

    /// Whether colours may have been drawn since the texels were made: recorded commands must run
    /// before [`Self::level`].
    pub(crate) fn is_stale(&self) -> bool {
        self.writes.load(Ordering::Relaxed) != self.synced
    }

    /// Whether a framebuffer draws, or drew, to planes of this image.
    pub(crate) fn has_planes(&self) -> bool {
        let depth = self
            .level
            .as_ref()
            .is_some_and(|level| matches!(level.texels(), Texels::DepthBuffer(_)));
        depth || self.stencil.is_some() || !self.colors.is_empty()
    }

    fn new_level(&self, texels: Texels) -> Arc<Level> {
        Arc::new(Level::new(self.size, self.border, texels))
    }

    /// The texels. Everything recorded must have run if the image is stale.
    pub(crate) fn level(&mut self) -> Arc<Level> {
        if let Some(level) = &self.level
            && !self.is_stale()
        {
            return level.clone();
        }
        let level = self.level.take().unwrap_or_else(|| self.blank_level());
        self.level = Some(level);
        self.pull_colors();
        self.level.clone().expect("just set")
    }

    /// As [`Self::level`], with depths of its own instead of a depth plane's.
    pub(crate) fn copied_level(&mut self) -> Arc<Level> {
        let level = self.level();
        if !matches!(level.texels(), Texels::DepthBuffer(_)) {
            return level;
        }
        let depths = self.depths();
        self.new_level(Texels::Depth(depths))
    }

    fn blank_level(&self) -> Arc<Level> {
        let texels = match (
            self.viewport(),
            self.format.has_depth() && self.border == 0 && self.size[2] == 1,
        ) {
            (Some(viewport), true) => {
                let mut plane =
                    DepthBuffer::new(Plane::new(viewport, 1, 0.0), self.format.depth_scale());
                plane.sampled = true;
                Texels::DepthBuffer(Arc::new(Mutex::new(plane)))
            }
            _ => texels::blank(&self.format, self.texel_count()),
        };
        self.new_level(texels)
    }

    /// Makes texels of attached layers from their planes.
    fn pull_colors(&mut self) {
        self.synced = self.writes.load(Ordering::Relaxed);
        let Some(level) = &mut self.level else { return };
        if self.colors.iter().all(Option::is_none) {
            return;
        }

        // Copy the texels if a snapshot shares them.
        let [width, height] = [self.size[0] as usize, self.size[1] as usize];
        let texels = Arc::make_mut(level).texels_mut();
        for (layer, plane) in self.colors.iter().enumerate() {
            let Some(plane) = plane else { continue };
            let plane = lock(plane);
            let mut words = vec![0; width];
            let mut floats = vec![[0.0; 4]; width];
            // Convert row by row.
            for y in 0..height {
                let first = (layer * height + y) * width;
                match (&*plane, &mut *texels) {
                    (ColorPlane::Rgba8(plane), Texels::Rgba8(texels) | Texels::Srgb8(texels)) => {
                        plane.read_row(0, y as u32, 0, &mut words);
                        let row = &mut texels[first..first + width];
                        row.iter_mut()
                            .zip(&words)
                            .for_each(|(t, &w)| *t = self.format.expand_word(w));
                    }
                    (ColorPlane::RgbaF32(plane), Texels::RgbaF32(texels)) => {
                        plane.read_row(0, y as u32, 0, &mut floats);
                        let row = &mut texels[first..first + width];
                        row.iter_mut().zip(&floats).for_each(|(t, &c)| *t = self.format.expand(c));
                    }
                    _ => {}
                }
            }
        }
    }

    /// Puts texels into attached layers' planes.
    fn push_colors(&mut self) {
        let Some(level) = &self.level else { return };
        for (layer, plane) in self.colors.iter().enumerate() {
            if let Some(plane) = plane {
                fill_color_plane(&mut lock(plane), &self.format, level, layer);
            }
        }
    }

    /// The plane that a framebuffer draws layer `layer` to.
    pub(crate) fn color_plane(&mut self, layer: usize) -> Option<Shared<ColorPlane>> {
        let viewport = self.viewport()?;
        if !self.format.is_color() || layer >= self.size[2] as usize {
            return None;
        }
        self.blocks = None;
        self.colors.resize(self.size[2] as usize, None);
        if let Some(plane) = &self.colors[layer] {
            return Some(plane.clone());
        }
        let mut plane = new_color_plane(&self.format, viewport, 1);
        if let Some(level) = &self.level {
            fill_color_plane(&mut plane, &self.format, level, layer);
        }
        let plane = Arc::new(Mutex::new(plane));
        self.colors[layer] = Some(plane.clone());
        Some(plane)
    }

    /// The plane that a framebuffer draws depths to.
    pub(crate) fn depth_plane(&mut self) -> Option<Shared<DepthBuffer>> {
        let viewport = self.viewport()?;
        if !self.format.has_depth() || self.size[2] != 1 {
            return None;
        }
        let level = self.level();
        if let Texels::DepthBuffer(plane) = level.texels() {
            return Some(plane.clone());
        }
        let scale = self.format.depth_scale();
        let mut plane = DepthBuffer::new(Plane::new(viewport, 1, 0.0), scale);
        plane.sampled = true;
        if let Texels::Depth(depths) = level.texels() {
            let rows = depths.chunks_exact(viewport.width as usize);
            for (y, row) in rows.enumerate() {
                let row: Vec<f32> = row.iter().map(|&d| stored_depth(d, scale)).collect();
                plane.resolved().write_row(0, y as u32, &row);
            }
        }
        let plane = Arc::new(Mutex::new(plane));
        self.level = Some(self.new_level(Texels::DepthBuffer(plane.clone())));
        Some(plane)
    }

    /// The plane that a framebuffer draws stencil values to.
    pub(crate) fn stencil_plane(&mut self) -> Option<Shared<StencilPlane>> {
        let viewport = self.viewport()?;
        if !self.format.has_stencil() || self.size[2] != 1 {
            return None;
        }
        let new = || Arc::new(Mutex::new(Plane::new(viewport, 1, 0)));
        Some(self.stencil.get_or_insert_with(new).clone())
    }

    /// Puts a box of texels at `origin` (borders count). Everything recorded must have run.
    pub(crate) fn write(&mut self, origin: [usize; 3], size: [usize; 3], data: &TexelData) {
        self.blocks = None;
        let full = self.full();
        if origin == [0; 3] && size == full && self.colors.is_empty() {
            self.replace(data.clone());
            return;
        }
        let mut level = self.level();
        self.level = None;
        if let (Texels::DepthBuffer(plane), TexelData::Depths(depths, _)) = (level.texels(), data) {
            write_depths(&mut lock(plane), origin, size, depths);
        } else {
            texels::put(Arc::make_mut(&mut level).texels_mut(), full, origin, size, data);
        }
        self.level = Some(level);
        self.write_stencils(origin, size, data);
        self.push_colors();
    }

    /// Sets all texels. The image must never have been attached as a colour.
    pub(crate) fn replace(&mut self, data: TexelData) {
        self.write_stencils([0; 3], self.full(), &data);
        if let (Some(level), TexelData::Depths(depths, _)) = (&self.level, &data)
            && let Texels::DepthBuffer(plane) = level.texels()
        {
            write_depths(&mut lock(plane), [0; 3], self.full(), depths);
            return;
        }
        let texels = match data {
            TexelData::Words(words) if self.format.storage == Storage::Srgb8 => {
                Texels::Srgb8(words)
            }
            TexelData::Words(words) => Texels::Rgba8(words),
            TexelData::Floats(colors) => Texels::RgbaF32(colors),
            TexelData::Depths(depths, _) => Texels::Depth(depths),
        };
        self.level = Some(self.new_level(texels));
    }

    fn write_stencils(&mut self, origin: [usize; 3], size: [usize; 3], data: &TexelData) {
        let TexelData::Depths(_, Some(stencils)) = data else { return };
        let Some(plane) = self.stencil_plane() else { return };
        let mut plane = lock(&plane);
        for (y, row) in stencils.chunks_exact(size[0].max(1)).enumerate() {
            plane.write_row(origin[0] as u32, (origin[1] + y) as u32, row);
        }
    }

    /// Lends words (red lowest) as `GetTexImage` returns them, if they are stored so. Everything
    /// recorded must have run.
    pub(crate) fn with_words<T>(&mut self, take: impl FnOnce(&[u32]) -> T) -> Option<T> {
        let kept = matches!(self.format.base, crate::enums::RGB | crate::enums::RGBA);
        match self.level().texels() {
            Texels::Rgba8(words) | Texels::Srgb8(words) if kept => Some(take(words)),
            _ => None,
        }
    }

    /// Colours as `GetTexImage` returns them: luminance and intensity in red alone. Everything
    /// recorded must have run.
    pub(crate) fn colors(&mut self) -> Vec<[f32; 4]> {
        let level = self.level();
        let mut colors: Vec<[f32; 4]> = match level.texels() {
            Texels::Rgba8(words) | Texels::Srgb8(words) => {
                words.iter().map(|&w| color_from_word(w)).collect()
            }
            Texels::RgbaF32(colors) => colors.clone(),
            Texels::Depth(_) | Texels::DepthBuffer(_) => Vec::new(),
        };
        if self.format.base_format() != vitral_raster::forward::BaseFormat::Rgb {
            use crate::enums::{INTENSITY, LUMINANCE, LUMINANCE_ALPHA};
            for color in &mut colors {
                match self.format.base {
                    LUMINANCE | INTENSITY => *color = [color[0], 0.0, 0.0, 1.0],
                    LUMINANCE_ALPHA => *color = [color[0], 0.0, 0.0, color[3]],
                    _ => {}
                }
            }
        }
        colors
    }

    /// Depths in 0..=1. Everything recorded must have run.
    pub(crate) fn depths(&mut self) -> Vec<f32> {
        match self.level().texels() {
            Texels::Depth(depths) => depths.clone(),
            Texels::DepthBuffer(plane) => {
                let mut plane = lock(plane);
                let viewport = plane.viewport();
                let mut depths = vec![0.0; (viewport.width * viewport.height) as usize];
                for (y, row) in depths.chunks_exact_mut(viewport.width as usize).enumerate() {
                    plane.resolved().read_row(0, y as u32, 0, row);
                    row.iter_mut()
                        .for_each(|d| *d = (f64::from(*d) / f64::from(plane.scale)) as f32);
                }
                depths
            }
            _ => Vec::new(),
        }
    }

    /// Stencil values. Everything recorded must have run.
    pub(crate) fn stencils(&mut self) -> Vec<u8> {
        let mut values = vec![0; self.texel_count()];
        if let Some(plane) = self.stencil_plane() {
            let plane = lock(&plane);
            for (y, row) in values.chunks_exact_mut(self.size[0] as usize).enumerate() {
                plane.read_row(0, y as u32, 0, row);
            }
        }
        values
    }
}

/// Copies layer `layer` of a level into a plane: texels are expanded, a framebuffer keeps what its
/// format stores.
fn fill_color_plane(plane: &mut ColorPlane, format: &InternalFormat, level: &Level, layer: usize) {
    let [width, height] = [level.size[0] as usize, level.size[1] as usize];
    for y in 0..height {
        let first = (layer * height + y) * width;
        match (&mut *plane, level.texels()) {
            (ColorPlane::Rgba8(plane), Texels::Rgba8(texels) | Texels::Srgb8(texels)) => {
                let row: Vec<_> =
                    texels[first..first + width].iter().map(|&w| format.kept_word(w)).collect();
                plane.write_row(0, y as u32, &row);
            }
            (ColorPlane::RgbaF32(plane), Texels::RgbaF32(texels)) => {
                let row: Vec<_> =
                    texels[first..first + width].iter().map(|&c| format.kept(c)).collect();
                plane.write_row(0, y as u32, &row);
            }
            _ => {}
        }
    }
}

/// Writes depths of 0..=1 into a plane.
pub(crate) fn write_depths(
    plane: &mut DepthBuffer,
    origin: [usize; 3],
    size: [usize; 3],
    depths: &[f32],
) {
    let mut stored = vec![0.0; size[0]];
    for (y, row) in depths.chunks_exact(size[0].max(1)).enumerate() {
        stored.iter_mut().zip(row).for_each(|(s, &d)| *s = stored_depth(d, plane.scale));
        plane.resolved().write_row(origin[0] as u32, (origin[1] + y) as u32, &stored);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::enums::*;

    fn image(token: u32, size: [u32; 3]) -> TextureImage {
        TextureImage::new(InternalFormat::of_texture(token).unwrap(), size, 0)
    }

    #[test]
    fn drawn_colours_come_back_as_texels() {
        let mut image = image(RGB, [2, 1, 1]);
        image.replace(TexelData::Words(vec![0xff00_00ff, 0xff00_ff00]));
        let before = image.level();
        let plane = image.color_plane(0).unwrap();
        let ColorPlane::Rgba8(samples) = &mut *lock(&plane) else { panic!() };
        assert_eq!(samples.get(1, 0, 0), 0xff00_ff00);
        samples.set(1, 0, 0, 0x0012_3456);
        image.writes.fetch_add(1, Ordering::Relaxed);
        assert!(image.is_stale());
        let Texels::Rgba8(_) = before.texels() else { panic!() };
    }

    #[test]
    fn stale_texels_are_made_again_and_old_ones_stay() {
        let mut image = image(RGB, [2, 1, 1]);
        image.replace(TexelData::Words(vec![0xff00_00ff, 0xff00_ff00]));
        let before = image.level();
        let plane = image.color_plane(0).unwrap();
        if let ColorPlane::Rgba8(samples) = &mut *lock(&plane) {
            samples.set(1, 0, 0, 0x0012_3456);
        }
        image.writes.fetch_add(1, Ordering::Relaxed);
        let words = |level: &Level| match level.texels() {
            Texels::Rgba8(words) => words.clone(),
            _ => panic!(),
        };
        // A texture without alpha samples 1, whatever was drawn.
        assert_eq!(words(&image.level()), [0xff00_00ff, 0xff12_3456]);
        assert_eq!(words(&before), [0xff00_00ff, 0xff00_ff00]);
        // New texels reach the plane.
        image.write([0; 3], [1, 1, 1], &TexelData::Words(vec![0xff00_0001]));
        let ColorPlane::Rgba8(samples) = &*lock(&plane) else { panic!() };
        assert_eq!(samples.get(0, 0, 0), 0xff00_0001);
    }

    #[test]
    fn planes_keep_what_their_format_stores() {
        for (token, kept) in
            [(INTENSITY, 0xff00_0010), (LUMINANCE_ALPHA, 0x1000_0010), (ALPHA, 0x1000_0000)]
        {
            let mut image = image(token, [1, 1, 1]);
            image.replace(TexelData::Words(vec![0x1010_1010]));
            let plane = image.color_plane(0).unwrap();
            let ColorPlane::Rgba8(plane) = &*lock(&plane) else { panic!() };
            assert_eq!(plane.get(0, 0, 0), kept);
        }
    }

    #[test]
    fn depth_becomes_a_plane_and_stays_one() {
        let mut image = image(DEPTH24_STENCIL8, [2, 1, 1]);
        image.replace(TexelData::Depths(vec![0.0, 1.0], Some(vec![3, 4])));
        let plane = image.depth_plane().unwrap();
        assert_eq!(lock(&plane).resolved().get(1, 0, 0), 16_777_215.0);
        image.write([0; 3], [1, 1, 1], &TexelData::Depths(vec![1.0], Some(vec![9])));
        assert_eq!(image.depths(), [1.0, 1.0]);
        assert_eq!(image.stencils(), [9, 4]);
    }
}
