//! NPY out: arrays for numpy, version 1.0, little-endian, C order, shape `(height, width)` or
//! `(height, width, 3)`.
//!
//! Source: \[NPY\].

use vitral_frame::Plane;

/// Writes a plane of floats.
pub fn npy_f32(plane: &Plane<f32>) -> Vec<u8> {
    let mut out = header("<f4", &[plane.height(), plane.width()]);
    out.extend(plane.data().iter().flat_map(|v| v.to_le_bytes()));
    out
}

/// Writes a plane of three floats each.
pub fn npy_f32x3(plane: &Plane<[f32; 3]>) -> Vec<u8> {
    let mut out = header("<f4", &[plane.height(), plane.width(), 3]);
    out.extend(plane.data().as_flattened().iter().flat_map(|v| v.to_le_bytes()));
    out
}

/// Writes a plane of unsigned integers.
pub fn npy_u32(plane: &Plane<u32>) -> Vec<u8> {
    let mut out = header("<u4", &[plane.height(), plane.width()]);
    out.extend(plane.data().iter().flat_map(|v| v.to_le_bytes()));
    out
}

/// Magic, version, and a dictionary padded with spaces so that the data starts at a multiple of 64
/// bytes.
fn header(kind: &str, shape: &[u32]) -> Vec<u8> {
    let shape: Vec<String> = shape.iter().map(ToString::to_string).collect();
    let dictionary =
        format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}), }}", shape.join(", "));
    let length = (10 + dictionary.len() + 1).next_multiple_of(64) - 10;
    let mut out = b"\x93NUMPY\x01\x00".to_vec();
    out.extend((length as u16).to_le_bytes());
    out.extend(format!("{dictionary:<width$}\n", width = length - 1).into_bytes());
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_ends_at_64_bytes() {
        let file = npy_u32(&Plane::from_rows(2, 1, vec![1, 0x0102_0304]).unwrap());
        assert_eq!(&file[..10], b"\x93NUMPY\x01\x00\x76\x00");
        let text = std::str::from_utf8(&file[10..128]).unwrap();
        assert!(
            text.starts_with("{'descr': '<u4', 'fortran_order': False, 'shape': (1, 2), }  ")
                && text.ends_with(" \n")
        );
        assert_eq!(&file[128..], [1, 0, 0, 0, 4, 3, 2, 1]);
        let normals = npy_f32x3(&Plane::from_rows(1, 1, vec![[1.0, 0.0, -1.0]]).unwrap());
        assert!(std::str::from_utf8(&normals[10..128]).unwrap().contains("'shape': (1, 1, 3)"));
        assert_eq!(normals.len(), 128 + 12);
        assert_eq!(npy_f32(&Plane::filled(3, 2, 0.5f32)).len(), 128 + 24);
    }
}
