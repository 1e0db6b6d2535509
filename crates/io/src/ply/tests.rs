use super::*;
use crate::{NoFiles, ResolveError};
use proptest::prelude::*;
use vitral_math::color::linear_from_srgb;
use vitral_scene::{Faces, Mesh};

fn read(bytes: &[u8]) -> Result<Scene, Error> {
    let scene = load(bytes, "t.ply", &NoFiles, &Workers::single())?;
    scene.meshes.iter().for_each(|m| m.check().unwrap());
    Ok(scene)
}

fn mesh(bytes: &[u8]) -> Mesh {
    Mesh::clone(&read(bytes).unwrap().meshes[0])
}

fn refusal(bytes: &[u8]) -> String {
    read(bytes).unwrap_err().to_string()
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
const LIST: &str = "property list uchar int vertex_indices\n";

fn text(elements: &str, data: &str) -> Vec<u8> {
    format!("ply\nformat ascii 1.0\ncomment c\n{elements}end_header\n{data}").into_bytes()
}

#[test]
fn text_with_everything() {
    let m = mesh(&text(
        &format!(
            "element vertex 4\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n{XYZ}property float s\nproperty float t\nproperty float nz\nproperty float ny\nproperty double nx\nelement face 2\n{LIST}element edge 1\nproperty int vertex1\nproperty int vertex2\n"
        ),
        "255 0 0 0 0 0 .25 .25 3 2 1\n0 0 0 1 0 0 0 0 1 0 0\n\n0 0 0 1 1 0 0 0 1 0 0\n0 0 0 0 1 0 0 0 1 0 0\n4 0 1 2 3\n3 0 1 2\n0 3\n",
    ));
    assert_eq!(
        m.faces,
        Faces::Polygons { starts: vec![0, 4, 7], corners: vec![0, 1, 2, 3, 0, 1, 2] }
    );
    assert_eq!((m.uvs[0].values[0], m.normals.unwrap().values[0]), ([0.25, 0.75], [1.0, 2.0, 3.0]));
    assert_eq!((m.colors.unwrap().values[0], m.lines), ([1.0, 0.0, 0.0, 1.0], vec![[0, 3]]));
}

#[test]
fn strips_turn_every_second_triangle() {
    let m = mesh(&text(
        &format!(
            "element vertex 4\n{XYZ}element tristrips 1\nproperty list int int vertex_indices\n"
        ),
        "0 0 0\n1 0 0\n0 1 0\n1 1 0\n10 0 1 2 3 3 -1 3 2 1 1\n",
    ));
    assert_eq!(m.triangles, [[0, 1, 2], [2, 1, 3], [3, 2, 1]]);
}

#[test]
fn colours_of_faces_count_where_vertices_have_none() {
    let face = "element face 2\nproperty float red\nproperty float green\nproperty float blue\n";
    let m = mesh(&text(
        &format!("element vertex 4\n{XYZ}{face}{LIST}"),
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n1 0 0 4 0 1 2 3\n0 1 0 3 0 1 2",
    ));
    let colors = m.colors.unwrap();
    assert_eq!(colors.corners, Some(vec![[0; 3], [0; 3], [1; 3]]));
    assert_eq!(colors.values, [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]]);
}

#[test]
fn a_full_channel_is_what_the_type_can_hold() {
    // The same grey of 100/255 in every type, as text and binary; with alpha and without.
    let colors = |kind: &str, alpha: &str| {
        let alpha =
            if alpha.is_empty() { String::new() } else { format!("property {alpha} alpha\n") };
        format!(
            "element vertex 2\n{XYZ}property {kind} red\nproperty {kind} green\nproperty {kind} blue\n{alpha}"
        )
    };
    let check = |bytes: &[u8], grey: f32, told: &[&str]| {
        let s = read(bytes).unwrap();
        assert_eq!(s.warnings, told);
        let found = s.meshes[0].colors.as_ref().unwrap().values[1];
        let [r, .., a] = found;
        assert!((r - linear_from_srgb(grey)).abs() < 1e-6 && a == 1.0, "{found:?} for {grey}");
    };
    for (kind, value, full, grey) in [
        ("char", "50", "127", 50.0 / 127.0),
        ("uchar", "50", "255", 50.0 / 255.0),
        ("short", "16384", "32767", 16384.0 / 32767.0),
        ("ushort", "16384", "65535", 16384.0 / 65535.0),
        ("int", "50", "255", 50.0 / 255.0),
        ("float", "0.25", "1", 0.25),
        ("double", "0.25", "1", 0.25),
    ] {
        check(
            &text(&colors(kind, ""), &format!("0 0 0 0 0 0\n0 0 0 {value} {value} {value}\n")),
            grey,
            &[],
        );
        let with_alpha =
            format!("0 0 0 {full} {full} {full} {full}\n0 0 0 {value} {value} {value} {full}\n");
        check(&text(&colors(kind, kind), &with_alpha), grey, &[]);
    }
    let bytes = "t.ply: colours exceed 1 and are read as 0 to 255";
    let data = "0 0 0 255 0 0 1\n0 0 0 50 50 50 1\n";
    check(&text(&colors("float", "float"), data), 50.0 / 255.0, &[bytes]);
    check(&text(&colors("double", ""), &data.replace(" 1\n", "\n")), 50.0 / 255.0, &[bytes]);
    let signed = "t.ply: colours exceed 127 and are read as 0 to 255";
    check(&text(&colors("char", ""), &data.replace(" 1\n", "\n")), 50.0 / 255.0, &[signed]);
    check(&text(&colors("int", ""), "0 0 0 300 0 0\n0 0 0 50 50 50\n"), 50.0 / 255.0, &[]);

    let binary = |kind: &str, rows: &[u8]| {
        let header = String::from_utf8(text(&colors(kind, ""), ""))
            .unwrap()
            .replace("ascii", "binary_little_endian");
        [header.as_bytes(), rows].concat()
    };
    let row = |color: &[u8]| [&[0; 12][..], color, color, color].concat();
    check(
        &binary("float", &[255f32, 50.0].map(|c| row(&c.to_le_bytes())).concat()),
        50.0 / 255.0,
        &[bytes],
    );
    check(
        &binary("short", &[32767i16, 16384].map(|c| row(&c.to_le_bytes())).concat()),
        16384.0 / 32767.0,
        &[],
    );
    check(&binary("uchar", &[row(&[255]), row(&[50])].concat()), 50.0 / 255.0, &[]);
}

#[test]
fn points_without_faces_and_missing_lists() {
    let s = read(&text(
        &format!("element vertex 2\n{XYZ}{LIST}property float confidence\n"),
        "0 0 0 0 1\n1 1 1 0 1\n",
    ))
    .unwrap();
    assert_eq!(s.meshes[0].points, [0, 1]);
    assert_eq!(
        s.warnings,
        ["t.ply: line 4: properties of `vertex` that are not used: `vertex_indices`, `confidence`"]
    );
    let s = read(&text(&format!("element vertex 1\n{XYZ}{LIST}"), "0 0 0\n")).unwrap();
    assert_eq!(
        s.warnings[1],
        "t.ply: line 10: the line ends before the list `vertex_indices`; taken as empty"
    );
}

#[test]
fn elements_without_what_makes_them_are_left_out() {
    let incomplete = "element face 1\nproperty uchar red\nelement edge 2\nproperty int vertex1\nelement tristrips 0\n";
    let told = [
        "t.ply: line 8: `face` without a list `vertex_indices` is left out",
        "t.ply: line 10: `edge` without `vertex1` and `vertex2` is left out",
    ];
    let s =
        read(&text(&format!("element vertex 1\n{XYZ}{incomplete}"), "0 0 0\n7\n0\n0\n")).unwrap();
    assert_eq!((&s.meshes[0].points, s.meshes[0].lines.len()), (&vec![0], 0));
    assert_eq!(s.warnings, told);
    let binary = "ply\nformat binary_little_endian 1.0\ncomment c\n";
    let mut bytes = format!("{binary}element vertex 1\n{XYZ}{incomplete}end_header\n").into_bytes();
    bytes.extend([0; 12 + 1 + 8]);
    assert_eq!(read(&bytes).unwrap().warnings, told);

    // A claim that nothing has to back.
    for element in ["edge", "face", "user"] {
        let elements =
            format!("element vertex 1\n{XYZ}element {element} 18446744073709551615\nend_header\n");
        let s = read(&[format!("{binary}{elements}").as_bytes(), &[0; 12]].concat()).unwrap();
        assert_eq!((s.meshes[0].points.len(), s.warnings.len()), (1, 1));
    }
}

#[test]
fn false_announcements_are_refused() {
    let vertex = |n: &str| format!("element vertex {n}\n{XYZ}");
    assert_eq!(
        refusal(&text(&vertex("99999999"), "0 0 0\n")),
        "t.ply: line 9: 99999999 elements `vertex` are announced, the file has 6 bytes left"
    );
    assert_eq!(
        refusal(&text(&vertex("3"), "0 0 0\n1 1 1\n")),
        "t.ply: line 11: the file ends here: 3 elements `vertex` are announced, 2 are there"
    );
    assert_eq!(refusal(&text(&vertex("1"), "0 0\n")), "t.ply: line 9: the file ends before `z`");
    assert_eq!(
        refusal(&text(&vertex("1"), "0 a 0\n")),
        "t.ply: line 9: `a` is no number, `y` is required"
    );
    let faces = format!("{}element face 1\n{LIST}", vertex("1"));
    assert_eq!(
        refusal(&text(&faces, "0 0 0\n3 0 0 1\n")),
        "t.ply: line 12: index 1, the file has 1 vertices"
    );
    assert_eq!(
        refusal(b"ply\nformat ascii 1.0\n"),
        "t.ply: line 3: the file ends here, `end_header` is required"
    );
    assert_eq!(refusal(b"ply\nend_header\n"), "t.ply: line 2: the header has no `format` line");
    assert_eq!(
        refusal(b"ply\nformat ascii 1.0\nend_header\n"),
        "t.ply: the header has no element `vertex`"
    );
    let huge =
        b"ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\nproperty float x\nend_header\n";
    assert!(refusal(huge).contains("`vertex` must have the properties"));
}

#[test]
fn elements_may_go_over_lines() {
    let faces = format!("element vertex 3\n{XYZ}element face 1\n{LIST}");
    for data in ["0 0 0\n1 0\n0\n0 1 0\n3 0\n1 2\n", "0\n0\n0\n1\n0\n0\n\n0\r\n1\r\n0\n3\n0\n1\n2"]
    {
        let s = read(&text(&faces, data)).unwrap();
        assert_eq!(
            (&s.meshes[0].triangles, s.meshes[0].positions[1]),
            (&vec![[0, 1, 2]], [1.0, 0.0, 0.0])
        );
        assert!(s.warnings[0].contains("the element goes on on the next"), "{:?}", s.warnings);
    }
}

/// A folder with one image of one pixel.
struct Images;

impl Resolver for Images {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        let pixel = vitral_frame::Plane::filled(1, 1, [9, 8, 7, 255]);
        match path {
            "my wood.png" => {
                Ok(crate::encode::png(&pixel, crate::encode::PngOptions { srgb: true }).unwrap())
            }
            path if path.starts_with("..") => Err(ResolveError::Outside),
            _ => Err(ResolveError::NotFound),
        }
    }
}

#[test]
fn faces_have_the_texture_coordinates_that_meshlab_writes() {
    let header = format!(
        "comment TextureFile ../out.png\ncomment TextureFile my wood.png\nelement vertex 4\n{XYZ}element face 4\n{LIST}\
        property list uchar float texcoord\nproperty int texnumber\n"
    );
    let data = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 8 0 0 1 0 1 1 0 1 1\n3 2 1 0 6 1 1 1 0 0 0 1\n\
        3 0 1 2 6 0 0 1 0 1 1 0\n3 0 1 2 2 0 0 -1\n";
    let s = load(&text(&header, data), "folder/t.ply", &Images, &Workers::single()).unwrap();
    let m = &s.meshes[0];
    m.check().unwrap();
    assert_eq!(m.uvs[0].at(1, &m.triangles), [[0.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
    assert_eq!(m.uvs[0].at(2, &m.triangles), [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(m.uvs[0].at(4, &m.triangles), [[0.0; 2]; 3]);
    let parts: Vec<_> = m.parts.iter().map(|p| (p.triangles.clone(), p.material)).collect();
    assert_eq!(parts, [(0..3, Some(0)), (3..4, None), (4..5, None)]);
    assert_eq!(
        (s.materials[0].name.as_str(), s.textures[0].name.as_str()),
        ("my wood", "my wood.png")
    );
    assert_eq!(
        s.warnings,
        [
            "folder/t.ply: line 22: 2 texture coordinates, a face with 3 corners needs 6; left out",
            "folder/t.ply: line 4: texture `../out.png` is left out: it lies outside the model's folder (--allow-external \
             permits that)",
        ]
    );

    // Binary rows are the same.
    let mut binary = format!(
        "ply\nformat binary_little_endian 1.0\ncomment TextureFile my wood.png\nelement vertex 3\n{XYZ}element face 1\n{LIST}\
        property list uchar float texcoord\nend_header\n"
    )
    .into_bytes();
    let floats =
        |out: &mut Vec<u8>, values: &[f32]| values.iter().for_each(|v| out.extend(v.to_le_bytes()));
    floats(&mut binary, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    binary.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 6]);
    floats(&mut binary, &[0.0, 0.0, 1.0, 0.0, 0.25, 1.0]);
    let s = load(&binary, "t.ply", &Images, &Workers::single()).unwrap();
    let m = &s.meshes[0];
    assert_eq!(
        (m.uvs[0].at(0, &m.triangles), m.parts[0].material),
        ([[0.0, 1.0], [1.0, 1.0], [0.25, 0.0]], Some(0))
    );

    // Coordinates of vertices show the first image.
    let vertex = format!(
        "comment TextureFile my wood.png\nelement vertex 3\n{XYZ}property float s\nproperty float t\n"
    );
    let data = "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
    let s = load(
        &text(&format!("{vertex}element face 1\n{LIST}"), data),
        "t.ply",
        &Images,
        &Workers::single(),
    )
    .unwrap();
    assert_eq!((s.meshes[0].parts[0].material, s.warnings.len()), (Some(0), 0));
}

/// A binary file of polygons; `wide` makes the layout unusual.
fn binary(big: bool, wide: bool, positions: &[[f32; 3]], faces: &[Vec<u32>]) -> Vec<u8> {
    let (kind, list) =
        if wide { ("double", "list ushort short") } else { ("float", "list uchar int") };
    let order = if big { "big" } else { "little" };
    let mut out = format!(
        "ply\r\nformat binary_{order}_endian 1.0\r\nelement vertex {}\r\n",
        positions.len()
    );
    out += &["x", "y", "z"].map(|axis| format!("property {kind} {axis}\r\n")).concat();
    out += &format!(
        "element extra 2\r\nproperty list uchar short a\r\nelement face {}\r\nproperty {list} vertex_index\r\nend_header\r\n",
        faces.len()
    );
    let mut out = out.into_bytes();
    let mut put = |bytes: &[u8]| {
        let mut bytes = bytes.to_vec();
        if big {
            bytes.reverse();
        }
        out.extend(bytes);
    };
    for &c in positions.as_flattened() {
        if wide { put(&f64::from(c).to_le_bytes()) } else { put(&c.to_le_bytes()) }
    }
    for bytes in [&[2u8][..], &[1, 0], &[2, 0], &[0]] {
        put(bytes);
    }
    for face in faces {
        if wide {
            put(&(face.len() as u16).to_le_bytes())
        } else {
            put(&[face.len() as u8])
        }
        for &i in face {
            if wide { put(&(i as u16).to_le_bytes()) } else { put(&i.to_le_bytes()) }
        }
    }
    out
}

#[test]
fn every_byte_order_and_layout_reads_the_same() {
    let positions = [[0.0, 0.5, 0.0], [1.0, 0.0, -2.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    for faces in [
        vec![vec![0, 1, 2], vec![0, 2, 3]],
        vec![vec![0, 1, 2, 3]],
        vec![vec![0, 1, 2], vec![3, 2, 1, 0]],
    ] {
        let expected = mesh(&binary(false, false, &positions, &faces));
        assert_eq!(expected.positions, positions);
        let corners: Vec<Vec<u32>> =
            (0..expected.face_count()).map(|f| expected.face_corners(f).to_vec()).collect();
        assert_eq!(corners, faces);
        for (big, wide) in [(true, false), (false, true), (true, true)] {
            assert_eq!(mesh(&binary(big, wide, &positions, &faces)), expected);
        }
    }
}

#[test]
fn broken_binary_data_are_refused_with_their_byte() {
    let good = binary(false, false, &[[0.0; 3]; 3], &[vec![0, 1, 2], vec![0, 1, 2]]);
    let end = good.len();
    assert_eq!(
        refusal(&good[..end - 1]),
        format!(
            "t.ply: byte {}: the file ends here: 2 elements `face` are announced, 1 are there",
            end - 1
        )
    );
    let bad = binary(false, false, &[[0.0; 3]; 3], &[vec![0, 1, 2], vec![0, 1, 3]]);
    assert_eq!(
        refusal(&bad),
        format!("t.ply: byte {}: element 1 of `face`: index 3, the file has 3 vertices", end - 13)
    );
    assert!(
        refusal(&good[..end - 30]).contains("`vertex` are announced, 2 are there")
            || refusal(&good[..end - 30]).contains("`extra`")
    );
    let few = binary(false, false, &[[0.0; 3]; 3], &[vec![0, 1], vec![0, 1, 2]]);
    assert_eq!(read(&few).unwrap().meshes[0].triangles, [[0, 1, 2]]);
    let longer = [good, vec![0; 3]].concat();
    assert_eq!(
        read(&longer).unwrap().warnings.last().unwrap(),
        &format!("t.ply: byte {end}: 3 bytes after the last element are left out")
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn polygons_survive_the_round_trip(
        positions in proptest::collection::vec(any::<[i16; 3]>(), 1..20),
        faces in proptest::collection::vec(proptest::collection::vec(any::<u32>(), 3..7), 0..12),
        big: bool,
        wide: bool,
    ) {
        // A model with the origin in its box is not moved there.
        let positions: Vec<[f32; 3]> = std::iter::once(&[0; 3]).chain(&positions).map(|p| p.map(f32::from)).collect();
        let faces: Vec<Vec<u32>> = faces.iter().map(|f| f.iter().map(|i| i % positions.len() as u32).collect()).collect();
        let m = mesh(&binary(big, wide, &positions, &faces));
        prop_assert_eq!(&m.positions, &positions);
        let corners: Vec<Vec<u32>> = (0..m.face_count()).map(|f| m.face_corners(f).to_vec()).collect();
        prop_assert_eq!(corners, faces);
    }
}
