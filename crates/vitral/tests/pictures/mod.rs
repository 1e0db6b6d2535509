//! Checks that need whole pictures: the course's (docs/course.md), the law of agreement, and what
//! must never fail.

mod agreement;
mod common;
mod coverage_masks;
mod culling;
mod cut_outs;
mod defects;
mod depth_bits;
mod depth_cue;
mod determinism;
mod drawn_surfaces;
mod equal_planes;
mod fill_light;
mod front_only;
mod hidden_line;
mod interpolation;
mod lighting;
mod lists;
mod looks;
mod marks;
mod normal_maps;
mod pixel_light;
mod ray_trace;
mod realism;
mod robust;
mod scene_files;
mod steps;
mod surroundings;
mod touching_glass;
mod translucent;
mod transparency;
mod traps;
mod window;
