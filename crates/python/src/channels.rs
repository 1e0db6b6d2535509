//! Channels of pictures as numpy arrays.

use crate::errors::usage;
use crate::values::shown;
use numpy::{
    Element, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadwriteArrayDyn,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::{Mutex, PoisonError};
use vitral::{Camera, Channels, Picture, Renderer, ViewTransform};

/// A channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    Rgb,
    Rgba,
    Depth,
    Ids,
    Faces,
    Materials,
    Normals,
    AttachedShadow,
    CastShadow,
}

/// The channels and their names.
const CHANNELS: [(Channel, &str); 9] = [
    (Channel::Rgb, "rgb"),
    (Channel::Rgba, "rgba"),
    (Channel::Depth, "depth"),
    (Channel::Ids, "ids"),
    (Channel::Faces, "faces"),
    (Channel::Materials, "materials"),
    (Channel::Normals, "normals"),
    (Channel::AttachedShadow, "attached_shadow"),
    (Channel::CastShadow, "cast_shadow"),
];

impl Channel {
    pub(crate) fn named(name: &str) -> PyResult<Self> {
        let found = CHANNELS.iter().find(|(_, known)| *known == name).map(|(channel, _)| *channel);
        let names = CHANNELS.map(|(_, name)| name).join(", ");
        found.ok_or_else(|| {
            usage(format!("there is no channel {name}"), format!("there are {names}"))
        })
    }

    /// The channels of a sequence of names, or of one name.
    pub(crate) fn all_named(names: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<Self>> {
        let Some(names) = names else { return Ok(vec![Self::Rgb]) };
        let names = match names.extract::<String>() {
            Ok(name) => vec![name],
            Err(_) => names.extract::<Vec<String>>()?,
        };
        if names.is_empty() {
            return Err(usage("channels: at least one is needed", ""));
        }
        names.iter().map(|name| Self::named(name)).collect()
    }

    /// The planes that the renderer makes for channels.
    pub(crate) fn request(channels: &[Self]) -> Channels {
        let has = |wanted: &[Self]| channels.iter().any(|channel| wanted.contains(channel));
        Channels {
            color: has(&[Self::Rgb, Self::Rgba]),
            depth: has(&[Self::Depth]),
            object: has(&[Self::Ids]),
            surface: has(&[Self::Faces]),
            material: has(&[Self::Materials]),
            normal: has(&[Self::Normals]),
            attached_shadow: has(&[Self::AttachedShadow]),
            cast_shadow: has(&[Self::CastShadow]),
            ..Channels { color: false, ..Channels::default() }
        }
    }

    /// Numbers of a pixel, where they are more than one.
    fn components(self) -> Option<usize> {
        match self {
            Self::Rgb | Self::Normals => Some(3),
            Self::Rgba => Some(4),
            _ => None,
        }
    }

    /// Whether the picture has it.
    pub(crate) fn is_in(self, picture: &Picture) -> bool {
        let frame = &picture.frame;
        match self {
            Self::Rgb | Self::Rgba => frame.color.is_some(),
            Self::Depth => frame.depth.is_some(),
            Self::Ids => frame.object.is_some(),
            Self::Faces => frame.surface.is_some(),
            Self::Materials => frame.material.is_some(),
            Self::Normals => frame.normal.is_some(),
            Self::AttachedShadow => frame.attached_shadow.is_some(),
            Self::CastShadow => frame.cast_shadow.is_some(),
        }
    }

    pub(crate) fn name(self) -> &'static str {
        CHANNELS.iter().find(|(channel, _)| *channel == self).map_or("rgb", |(_, name)| name)
    }
}

/// An array that is filled.
pub(crate) enum Target<'py> {
    Bytes(PyReadwriteArrayDyn<'py, u8>),
    Floats(PyReadwriteArrayDyn<'py, f32>),
    Numbers(PyReadwriteArrayDyn<'py, i32>),
}

/// The memory of one picture of an array.
pub(crate) enum Pixels<'a> {
    Bytes(&'a mut [u8]),
    Floats(&'a mut [f32]),
    Numbers(&'a mut [i32]),
}

impl<'py> Target<'py> {
    /// A fresh array for `pictures` (`None`: one, without an axis of its own) of a size, or `out`
    /// if it fits.
    pub(crate) fn new(
        py: Python<'py>,
        channel: Channel,
        pictures: Option<usize>,
        [width, height]: [u32; 2],
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let shape: Vec<usize> = pictures
            .into_iter()
            .chain([height as usize, width as usize])
            .chain(channel.components())
            .collect();
        Ok(match channel {
            Channel::Rgb | Channel::Rgba => Self::Bytes(array(py, channel, &shape, out)?),
            Channel::Ids | Channel::Faces | Channel::Materials => {
                Self::Numbers(array(py, channel, &shape, out)?)
            }
            _ => Self::Floats(array(py, channel, &shape, out)?),
        })
    }

    /// The memory of each picture.
    pub(crate) fn pictures(&mut self, count: usize) -> PyResult<Vec<Pixels<'_>>> {
        fn cut<'a, T, P>(all: &'a mut [T], count: usize, of: impl Fn(&'a mut [T]) -> P) -> Vec<P> {
            let length = all.len() / count.max(1);
            if length == 0 { Vec::new() } else { all.chunks_mut(length).map(of).collect() }
        }
        Ok(match self {
            Self::Bytes(array) => cut(array.as_slice_mut()?, count, Pixels::Bytes),
            Self::Floats(array) => cut(array.as_slice_mut()?, count, Pixels::Floats),
            Self::Numbers(array) => cut(array.as_slice_mut()?, count, Pixels::Numbers),
        })
    }

    /// The array.
    fn array(self) -> Bound<'py, PyAny> {
        match self {
            Self::Bytes(array) => (**array).clone().into_any(),
            Self::Floats(array) => (**array).clone().into_any(),
            Self::Numbers(array) => (**array).clone().into_any(),
        }
    }

    /// What a render gives: the only array, or a tuple.
    pub(crate) fn result(py: Python<'py>, mut targets: Vec<Self>) -> PyResult<Bound<'py, PyAny>> {
        match targets.len() {
            1 => Ok(targets.remove(0).array()),
            _ => Ok(PyTuple::new(py, targets.into_iter().map(Self::array))?.into_any()),
        }
    }
}

/// A fresh array, or `out` if it has this shape and type, lies in one piece and may be written.
fn array<'py, T: Element>(
    py: Python<'py>,
    channel: Channel,
    shape: &[usize],
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<PyReadwriteArrayDyn<'py, T>> {
    let Some(out) = out else {
        return Ok(PyArrayDyn::<T>::zeros(py, shape, false).readwrite());
    };
    let name = channel.name();
    let wanted = shown(&shape.iter().copied().map(Some).collect::<Vec<_>>());
    let dtype = numpy::dtype::<T>(py);
    let needed = format!(
        "out: the channel {name} needs a writeable C-contiguous array of dtype {dtype} and shape {wanted}"
    );
    let Ok(untyped) = out.cast::<numpy::PyUntypedArray>() else {
        return Err(PyTypeError::new_err(format!("{needed}, got {}", out.get_type().name()?)));
    };
    if !untyped.dtype().is_equiv_to(&dtype) {
        return Err(PyTypeError::new_err(format!("{needed}, got dtype {}", untyped.dtype())));
    }
    if untyped.shape() != shape || !untyped.is_c_contiguous() {
        let got = shown(&untyped.shape().iter().copied().map(Some).collect::<Vec<_>>());
        return Err(PyValueError::new_err(format!("{needed}, got shape {got}")));
    }
    let array = out.cast::<PyArrayDyn<T>>()?.clone();
    array.try_readwrite().map_err(|e| PyValueError::new_err(format!("{needed}: {e}")))
}

/// Writes the channel of a picture that was seen so.
pub(crate) fn fill_from(
    channel: Channel,
    picture: &Picture,
    view: &ViewTransform,
    pixels: &mut Pixels<'_>,
) {
    let frame = &picture.frame;
    match (channel, pixels) {
        (Channel::Rgba, Pixels::Bytes(to)) => to.copy_from_slice(picture.rgba8()),
        (Channel::Rgb, Pixels::Bytes(to)) => {
            // Leave the alpha out.
            let (to, from) = (to.as_chunks_mut::<3>().0, picture.rgba8().as_chunks::<4>().0);
            to.iter_mut().zip(from).for_each(|(to, [r, g, b, _])| *to = [*r, *g, *b]);
        }
        (Channel::Depth, Pixels::Floats(to)) => {
            // Convert the depths to distances; the background is infinitely far away.
            let distance = |depth: f32| {
                if depth > 0.0 { view.distance_at(depth) as f32 } else { f32::INFINITY }
            };
            let depths = frame.depth.iter().flat_map(|plane| plane.data());
            to.iter_mut().zip(depths).for_each(|(to, depth)| *to = distance(*depth));
        }
        (Channel::Normals, Pixels::Floats(to)) => {
            let normals = frame.normal.iter().flat_map(|plane| plane.data().as_flattened());
            to.iter_mut().zip(normals).for_each(|(to, value)| *to = *value);
        }
        (Channel::AttachedShadow | Channel::CastShadow, Pixels::Floats(to)) => {
            let plane = if channel == Channel::CastShadow {
                &frame.cast_shadow
            } else {
                &frame.attached_shadow
            };
            to.iter_mut()
                .zip(plane.iter().flat_map(|plane| plane.data()))
                .for_each(|(to, value)| *to = *value);
        }
        (_, Pixels::Numbers(to)) => {
            let plane = match channel {
                Channel::Ids => &frame.object,
                Channel::Faces => &frame.surface,
                _ => &frame.material,
            };
            // The background is the largest number, which is -1 with a sign.
            to.iter_mut()
                .zip(plane.iter().flat_map(|plane| plane.data()))
                .for_each(|(to, id)| *to = id.cast_signed());
        }
        _ => {}
    }
}

/// The memory of many pictures, which threads take one by one.
pub(crate) struct Shelf<'a>(Vec<Mutex<Vec<(Channel, Pixels<'a>)>>>);

impl<'a> Shelf<'a> {
    /// The memory of `count` pictures in the targets of `channels`.
    pub(crate) fn new(
        channels: &[Channel],
        targets: &'a mut [Target<'_>],
        count: usize,
    ) -> PyResult<Self> {
        let mut pictures: Vec<Vec<(Channel, Pixels<'a>)>> =
            (0..count).map(|_| Vec::new()).collect();
        for (channel, target) in channels.iter().zip(targets) {
            for (picture, pixels) in pictures.iter_mut().zip(target.pictures(count)?) {
                picture.push((*channel, pixels));
            }
        }
        Ok(Self(pictures.into_iter().map(Mutex::new).collect()))
    }

    /// Writes picture `i`.
    pub(crate) fn fill(&self, i: usize, picture: &Picture, renderer: &Renderer, camera: &Camera) {
        let view = renderer.view_transform(camera);
        let mut channels = self.0[i].lock().unwrap_or_else(PoisonError::into_inner);
        for (channel, pixels) in channels.iter_mut() {
            fill_from(*channel, picture, &view, pixels);
        }
    }
}
