//! Writers: what goes out comes back.

use proptest::prelude::*;
use vitral_frame::Plane;
use vitral_io::encode::{PngOptions, decode_picture, jpeg, png, ppm};

fn pictures() -> impl Strategy<Value = Plane<[u8; 4]>> {
    (1u32..40, 1u32..40, any::<bool>()).prop_flat_map(|(w, h, opaque)| {
        prop::collection::vec(any::<[u8; 4]>(), (w * h) as usize).prop_map(move |mut data| {
            if opaque {
                data.iter_mut().for_each(|p| p[3] = 255);
            }
            Plane::from_rows(w, h, data).unwrap()
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn png_is_without_loss(picture in pictures(), srgb in any::<bool>()) {
        let file = png(&picture, PngOptions { srgb }).unwrap();
        prop_assert_eq!(decode_picture(&file, "a.png").unwrap(), picture);
    }

    #[test]
    fn ppm_and_jpeg_keep_the_size(picture in pictures()) {
        for file in [ppm(&picture).unwrap(), jpeg(&picture, 90).unwrap()] {
            let back = decode_picture(&file, "a").unwrap();
            prop_assert_eq!((back.width(), back.height()), (picture.width(), picture.height()));
            prop_assert!(back.data().iter().all(|p| p[3] == 255));
        }
    }

    #[test]
    fn damaged_pictures_never_panic(
        picture in pictures(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        which in 0usize..3,
    ) {
        let mut file = [png(&picture, PngOptions::default()), jpeg(&picture, 50), ppm(&picture)][which].clone().unwrap();
        for (at, byte) in changes {
            let at = at.index(file.len());
            file[at] = byte;
        }
        let _ = decode_picture(&file, "a");
    }
}

#[test]
fn a_rendered_looking_picture_is_small() {
    // A smooth ramp with a disc: at least four times smaller than its bytes.
    let (w, h) = (256u32, 192u32);
    let pixel = |i: u32| {
        let (x, y) = (i % w, i / w);
        let (dx, dy) = (x as f32 - 128.0, y as f32 - 96.0);
        let inside = dx * dx + dy * dy < 60.0 * 60.0;
        if inside {
            [(x / 2) as u8, (y / 2) as u8, 90, 255]
        } else {
            [200, 210, (220 - y / 8) as u8, 255]
        }
    };
    let picture = Plane::from_rows(w, h, (0..w * h).map(pixel).collect()).unwrap();
    let file = png(&picture, PngOptions::default()).unwrap();
    assert!(file.len() * 4 < picture.data().len() * 3, "{} bytes", file.len());
}
