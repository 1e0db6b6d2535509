//! Pixels: formats, textures, framebuffers, clears, copies.
//!
//! The way of an image: [`store`] takes it from the client's memory as tight rows, [`decode`] makes
//! colours, depths or stencil values of it with [`transfer`], [`texels`] what an
//! [`internal_format`] stores of them. [`encode`] and [`store`] lead back. [`texture`],
//! [`renderbuffer`] and [`default`] own what framebuffers draw to; [`target`] finds it.

mod accum;
mod answers;
mod attachments;
mod binding;
mod bitmap;
mod blit;
mod buffer;
mod clear;
mod client_buffer;
mod compressed;
mod copy_plane;
mod copy_tex;
mod decode;
mod default;
mod draw_pixels;
mod encode;
mod format;
mod framebuffer;
mod framebuffer_query;
mod image;
mod internal_format;
mod mipmap;
mod read_pixels;
mod renderbuffer;
mod s3tc;
mod sampler;
mod store;
mod target;
#[cfg(test)]
mod testing;
mod tex_image;
mod tex_parameter;
mod tex_query;
mod tex_storage;
mod tex_sub_image;
mod texels;
mod texture;
mod transfer;

/// Pixels in one piece of work between the client and the planes or texels: small images are one.
const PIXELS_A_JOB: usize = 1 << 14;

#[allow(unused_imports)]
pub(crate) use answers::{FramebufferBits, SavedTextures};
pub(crate) use binding::TextureBindings;
pub(crate) use default::DefaultFramebuffer;
pub use default::{BufferInfo, DepthCopy, OSMESA_ARGB, OSMESA_BGR, OSMESA_BGRA, OSMESA_RGB_565};
pub(crate) use format::float_from_half;
pub(crate) use framebuffer::FramebufferBindings;
pub(crate) use renderbuffer::RenderbufferHandle;
pub(crate) use sampler::SamplerHandle;
pub(crate) use texture::TextureHandle;

/// The error that a call records, and why.
type Failure = (u32, &'static str);
