//! Prepare: from the world to draws that a visibility algorithm can take, with one numbering and
//! one depth function.
//!
//! Facets are the triangles of all instances, counted in scene order before anything is culled. For
//! any facet, [`PreparedView::setups`] gives its pieces on the screen, whose `covers` and `depth`
//! say which samples they cover and how near they are there; the z-buffer's kernels compute the
//! same in bulk.

use crate::cull::frustum::{self, VisibleInstance};
use crate::cull::opacity::is_layered;
use crate::cull::window::PixelWindow;
use crate::stats::CullCounters;
use crate::trace::Step;
use crate::{Acceleration, Coherence, CoherenceSet, Execution, Session, Settings, Transparency};
use std::ops::Range;
use vitral_exec::Workers;
use vitral_light::Material;
use vitral_math::lanes::Level;
use vitral_math::{DMat4, DVec3, DVec4, Mat4, Vec4};
use vitral_raster::clip::{PLANES, Polygon, clip, clip_watched};
use vitral_raster::geometry::{Screen, flag, transform_point};
use vitral_raster::{
    BackFaces, Batch, Draw, Layer, LayerList, SamplePattern, ScreenVertex, Setup, SharedPlane,
    TILE, Viewport,
};
use vitral_scene::{Camera, Instance, SharedPlanes, ViewTransform, depth_range};

/// One instance's triangles, ready for the rasteriser.
#[derive(Clone, Debug)]
pub struct PreparedInstance<'a> {
    /// Index into the world's instances.
    pub instance: usize,
    /// Opaque triangles.
    pub opaque: Vec<Draw<'a>>,
    /// Triangles through which something behind may be seen.
    pub layered: Vec<Draw<'a>>,
}

/// A scene seen from a camera, before visibility is decided.
#[derive(Debug)]
pub struct PreparedView<'a> {
    /// The scene and what is known of it.
    pub session: &'a Session,
    /// Camera matrices.
    pub view: ViewTransform,
    /// The viewer, world space.
    pub camera: Camera,
    /// Size of the picture.
    pub viewport: Viewport,
    /// Where the samples of a pixel lie.
    pub pattern: SamplePattern,
    /// The map to the screen.
    pub screen: Screen,
    /// What finds the triangles near a ray, for algorithms that follow rays.
    pub acceleration: Acceleration,
    /// The kinds of coherence that are used.
    pub coherence: CoherenceSet,
    /// Whether layers come in the order of a list of polygons, where the algorithm makes one.
    pub lists_layers: bool,
    /// Bits of integer depths, of the z-buffer.
    pub depth_bits: Option<u32>,
    /// Most layers in a tile.
    layer_limit: usize,
    /// What may be visible, in scene order.
    pub instances: Vec<PreparedInstance<'a>>,
    /// The only tile that is made; `None`: all are.
    only_tile: Option<usize>,
}

/// What a material's triangles are to a visibility algorithm.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Class {
    layered: bool,
    double_sided: bool,
    /// Back faces are not seen, whether the mesh is closed or not.
    front_only: bool,
}

impl<'a> PreparedView<'a> {
    /// Culls and sorts the scene's triangles by what they need.
    pub fn new(
        session: &'a Session,
        camera: &Camera,
        settings: &Settings,
        viewport: Viewport,
        pattern: SamplePattern,
        execution: &Execution,
        counters: &mut CullCounters,
    ) -> Self {
        // Cull objects outside the view volume.
        let aspect = f64::from(viewport.width) / f64::from(viewport.height);
        let view = camera.transform(aspect, depth_range(camera, &session.world.bounds));
        let clip_from_world = view.clip_from_world();
        let coherence = settings.coherence();
        let cull_objects = settings.cull.frustum && coherence.has(Coherence::Object);
        let visible = frustum::cull(session, &clip_from_world, cull_objects, execution, counters);

        // Sort the visible triangles into draws.
        let preparation =
            Preparation { session, camera, settings, view: &view, clip_from_world, execution };
        let instances: Vec<_> =
            visible.into_iter().map(|visible| preparation.instance(&visible)).collect();
        let drops = |draw: &Draw<'_>| draw.back_faces != BackFaces::Kept;
        counters.back_face_culled_instances +=
            instances.iter().filter(|instance| instance.opaque.iter().any(drops)).count() as u64;

        // Bring the planes shared by facets to the screen.
        let planes = equal_planes(
            session.planes(&execution.workers),
            &clip_from_world,
            viewport,
            &execution.workers,
        );
        let screen = Screen::new(viewport, &pattern).with_planes(planes);
        let acceleration = settings.acceleration.unwrap_or_default();
        let layer_limit = layer_limit(viewport, settings.transparency.layer_memory);
        Self {
            session,
            view,
            camera: *camera,
            viewport,
            pattern,
            screen,
            acceleration,
            coherence,
            depth_bits: settings.depth_bits,
            lists_layers: settings.transparency.order.needs_list,
            layer_limit,
            instances,
            only_tile: None,
        }
    }

    /// Leaves the tile with this number alone to be made, of the facets that may touch it: it
    /// becomes what it is in the whole picture, whatever the algorithm.
    pub fn limit_to_tile(&mut self, tile: usize) {
        let (columns, side) = (self.viewport.tiles_x(), TILE as u32);
        let corner = [tile as u32 % columns * side, tile as u32 / columns * side];
        // A pixel more than the tile covers what projecting and snapping round.
        let window = PixelWindow::new(&self.view, self.viewport, corner, side, 1.0);
        let (session, world) = (self.session, &self.session.world);
        for prepared in &mut self.instances {
            let instance = &world.instances[prepared.instance];
            let pyramid = window.pyramid_of(instance);
            for draw in prepared.opaque.iter_mut().chain(&mut prepared.layered) {
                let runs = &session.world.run_bounds[instance.mesh_index as usize];
                draw.ranges = pyramid.triangles(&instance.mesh, runs, &draw.ranges);
            }
            prepared.opaque.retain(|draw| !draw.ranges.is_empty());
            prepared.layered.retain(|draw| !draw.ranges.is_empty());
        }
        self.only_tile = Some(tile);
    }

    /// Whether all tiles are.
    pub(crate) fn makes_all_tiles(&self) -> bool {
        self.only_tile.is_none()
    }

    /// Whether the tile with this number is made.
    pub(crate) fn makes_tile(&self, tile: usize) -> bool {
        self.only_tile.is_none_or(|only| only == tile)
    }

    /// An empty list for the layers of a tile.
    pub(crate) fn layer_list(&self) -> LayerList {
        let list = LayerList::new(self.layer_limit, self.pattern.len());
        if self.lists_layers { list.from_back_to_front() } else { list }
    }

    /// The viewer in world space, and whether projectors meet there.
    pub fn eye(&self) -> (DVec3, bool) {
        (self.camera.position, self.view.perspective)
    }

    /// The same as one homogeneous point: `w` is 0 in a parallel view, the rest points towards the
    /// viewer.
    pub fn viewer(&self) -> DVec4 {
        let (eye, perspective) = self.eye();
        if perspective {
            eye.extend(1.0)
        } else {
            self.view.view_from_world.row(2).truncate().extend(0.0)
        }
    }

    /// The pieces of a facet on the screen (several if it was clipped), culled as the draws say.
    /// For tests, reports and algorithms that take facets one by one.
    pub fn setups(&self, facet: u32, back_faces: BackFaces<'_>) -> Vec<Setup> {
        self.set_up(facet, back_faces).setups().to_vec()
    }

    /// A batch of one facet, which counts what became of it.
    pub(crate) fn set_up(&self, facet: u32, back_faces: BackFaces<'_>) -> Batch {
        let level = Level::new();
        let (instance, corners, clip_from_model, vertices) = self.placed(level, facet);
        let triangle = (facet - instance.first_facet) as usize;
        let planes = self.session.planes(&Workers::single());
        let of_facet = planes.of(facet..facet + 1);
        let draw = Draw {
            positions: &corners,
            triangles: &[[0, 1, 2]],
            ranges: Vec::new(),
            clip_from_model,
            first_facet: facet,
            back_faces: if back_faces.drops(triangle as u32) {
                BackFaces::Dropped
            } else {
                BackFaces::Kept
            },
            planes: of_facet,
            mirrored: mirrors(&instance.world_from_model),
        };
        let mut batch = Batch::default();
        batch.add(level, &draw, &vertices, 0..1, &self.screen);
        batch
    }

    /// On which sides of the planes of the view the corners of a facet lie, see [`flag`].
    pub(crate) fn corner_flags(&self, facet: u32) -> [u32; 3] {
        self.placed(Level::new(), facet).3.map(|vertex| vertex.flags)
    }

    /// The polygon in clip space that clipping leaves of a facet, before the division by `w`, and
    /// whether it was cut; `None` if nothing is left. Only near and far plane and a guard band
    /// round the picture cut, and facets that lie beyond one plane of the view are dropped whole.
    /// Which way it faces is asked later.
    pub fn clipped(&self, facet: u32) -> Option<(Vec<Vec4>, bool)> {
        let (_, corners, clip_from_model, vertices) = self.placed(Level::new(), facet);
        let [a, b, c] = vertices.map(|v| v.flags);
        if (a | b | c) & flag::NOT_FINITE != 0 || a & b & c & flag::FRUSTUM != 0 {
            return None;
        }
        let corners = corners.map(|p| transform_point(&clip_from_model, p));
        if (a | b | c) & flag::CLIP == 0 {
            return Some((corners.to_vec(), false));
        }
        let polygon = clip(Polygon::triangle(corners), self.screen.transform().guard());
        (polygon.corners().len() >= 3).then(|| (polygon.corners().to_vec(), true))
    }

    /// Tells the planes that cut the facets in view, facet by facet: the polygon before and after
    /// each.
    pub(crate) fn tell_clipping(&self, execution: &Execution) {
        let draws = || self.instances.iter().flat_map(|i| i.opaque.iter().chain(&i.layered));
        let facets_of = |draw: &Draw<'_>| {
            let triangles = draw.ranges.iter().cloned().flatten();
            triangles.map(|triangle| draw.first_facet + triangle).collect::<Vec<_>>()
        };
        let points =
            |polygon: &Polygon| polygon.corners().iter().map(|corner| corner.to_array()).collect();
        for facet in draws().flat_map(facets_of) {
            let (_, corners, clip_from_model, vertices) = self.placed(Level::new(), facet);
            let flags = vertices.iter().fold(0, |all, vertex| all | vertex.flags);
            let beyond =
                vertices.iter().fold(flag::FRUSTUM, |common, vertex| common & vertex.flags);
            if flags & flag::NOT_FINITE != 0 || flags & flag::CLIP == 0 || beyond != 0 {
                continue;
            }
            let triangle = Polygon::triangle(corners.map(|p| transform_point(&clip_from_model, p)));
            clip_watched(triangle, self.screen.transform().guard(), |plane, before, after| {
                let (plane, before, after) = (PLANES[plane], points(before), points(after));
                execution.report(|| Step::Clipped { facet, plane, before, after });
            });
        }
    }

    /// A facet's instance, its corners, the matrix from their space to clip space, and where that
    /// brings them.
    fn placed(
        &self,
        level: Level,
        facet: u32,
    ) -> (&'a Instance, [[f32; 3]; 3], Mat4, [ScreenVertex; 3]) {
        let world = &self.session.world;
        let instance = &world.instances[world.instance_of_facet(facet)];
        let triangle = instance.mesh.triangles[(facet - instance.first_facet) as usize];
        let (positions, clip_from_model) =
            self.session.placed_positions(instance, &self.view.clip_from_world());
        let corners = triangle.map(|i| positions[i as usize]);
        let mut vertices = [ScreenVertex::default(); 3];
        vitral_raster::transform(
            level,
            &corners,
            &clip_from_model,
            self.screen.transform(),
            &mut vertices,
        );
        (instance, corners, clip_from_model, vertices)
    }
}

/// Planes in one piece of work.
const PLANES_A_JOB: usize = 4096;

/// The depths of planes that several facets lie in, as this view has them.
fn equal_planes(
    planes: &SharedPlanes,
    clip_from_world: &DMat4,
    viewport: Viewport,
    workers: &Workers,
) -> Vec<Option<SharedPlane>> {
    let size = [viewport.width, viewport.height];
    // A plane goes by the inverse, transposed.
    let plane_from_world =
        (*clip_from_world * DMat4::from_translation(planes.center())).inverse().transpose();
    let mut shared = vec![None; planes.equations().len()];
    workers.for_each_chunk(&mut shared, PLANES_A_JOB, |chunk, shared| {
        for (shared, equation) in shared.iter_mut().zip(&planes.equations()[chunk * PLANES_A_JOB..])
        {
            *shared = SharedPlane::new((plane_from_world * *equation).to_array(), size);
        }
    });
    shared
}

/// Whether only the outside of an instance can be seen: its mesh is solid without a window, and the
/// near plane does not cut it open.
pub fn is_solid(
    session: &Session,
    instance: &Instance,
    camera: &Camera,
    view: &ViewTransform,
    settings: &Settings,
    execution: &Execution,
) -> bool {
    is_outside(instance, camera, view)
        && session.is_solid(instance.mesh_index, settings.transparency.model, &execution.workers)
}

/// Whether an instance lies wholly beyond the near plane, so that nothing is seen from within.
fn is_outside(instance: &Instance, camera: &Camera, view: &ViewTransform) -> bool {
    depth_range(camera, &instance.bounds).0 > view.near
}

/// How many layers each tile may have when all of them together take `bytes`.
fn layer_limit(viewport: Viewport, bytes: u64) -> usize {
    let tiles = u64::from(viewport.tiles_x()) * u64::from(viewport.tiles_y());
    (bytes / (tiles * size_of::<Layer>() as u64)).try_into().unwrap_or(usize::MAX)
}

/// Whether a transform turns left-handed into right-handed.
pub fn mirrors(transform: &DMat4) -> bool {
    transform.determinant() < 0.0
}

/// The opacity class of a material.
fn class(material: Option<&Material>, transparency: Transparency) -> Class {
    Class {
        layered: is_layered(material, transparency),
        double_sided: material.is_some_and(|m| m.double_sided),
        front_only: material.is_some_and(|m| m.front_only && !m.double_sided),
    }
}

/// What instances are prepared with.
struct Preparation<'p, 'a> {
    session: &'a Session,
    camera: &'p Camera,
    settings: &'p Settings,
    view: &'p ViewTransform,
    clip_from_world: DMat4,
    execution: &'p Execution,
}

impl<'a> Preparation<'_, 'a> {
    /// An instance's draws, opaque ones apart from layers.
    fn instance(&self, visible: &VisibleInstance) -> PreparedInstance<'a> {
        let session = self.session;
        let instance = &session.world.instances[visible.instance];
        let mut prepared = PreparedInstance {
            instance: visible.instance,
            opaque: Vec::new(),
            layered: Vec::new(),
        };
        if matches!(self.settings.picture.lines, crate::Lines::Wireframe) {
            return prepared;
        }
        let drops = self.settings.cull.back_face && is_outside(instance, self.camera, self.view);
        let back_faces = |class: Class| {
            if class.front_only && !self.settings.shows_all_backs {
                return BackFaces::Dropped;
            }
            if !drops || class.double_sided || class.layered {
                return BackFaces::Kept;
            }
            session.back_faces(
                instance.mesh_index,
                self.settings.transparency.model,
                &self.execution.workers,
            )
        };
        for (class, draw) in self.draws(instance, &visible.ranges, back_faces) {
            if class.layered { &mut prepared.layered } else { &mut prepared.opaque }.push(draw);
        }
        prepared
    }

    /// Cuts an instance's visible ranges by class, in order, one draw a class.
    fn draws(
        &self,
        instance: &'a Instance,
        ranges: &[Range<u32>],
        back_faces: impl Fn(Class) -> BackFaces<'a>,
    ) -> Vec<(Class, Draw<'a>)> {
        // Find the mesh's positions on their way to clip space, and its planes.
        let mesh = &*instance.mesh;
        let (positions, clip_from_model) =
            self.session.placed_positions(instance, &self.clip_from_world);
        let facets = instance.first_facet..instance.first_facet + mesh.triangles.len() as u32;
        let planes = self.session.planes(&self.execution.workers).of(facets);
        let new_draw = |class: Class| Draw {
            positions,
            triangles: &mesh.triangles,
            ranges: Vec::new(),
            clip_from_model,
            first_facet: instance.first_facet,
            back_faces: back_faces(class),
            planes,
            mirrored: mirrors(&instance.world_from_model),
        };

        // Append each range of a part to the draw of its class.
        let mut draws: Vec<(Class, Draw<'a>)> = Vec::new();
        for part in &mesh.parts {
            let material = part.material.and_then(|m| self.session.scene.materials.get(m as usize));
            let class = class(material, self.settings.transparency.model);
            for range in ranges {
                let (start, end) =
                    (range.start.max(part.triangles.start), range.end.min(part.triangles.end));
                if start >= end {
                    continue;
                }
                let index = draws.iter().position(|(c, _)| *c == class).unwrap_or_else(|| {
                    draws.push((class, new_draw(class)));
                    draws.len() - 1
                });
                let ranges = &mut draws[index].1.ranges;
                match ranges.last_mut() {
                    Some(last) if last.end == start => last.end = end,
                    _ => ranges.push(start..end),
                }
            }
        }
        draws
    }
}
