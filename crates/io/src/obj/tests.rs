use super::*;
use crate::{NoFiles, ResolveError};
use proptest::prelude::*;
use vitral_light::Reflectance;
use vitral_scene::{Faces, Mesh};

fn read(text: &str) -> Scene {
    let scene = load(text.as_bytes(), "t.obj", &NoFiles, &Workers::single()).unwrap();
    scene.meshes.iter().for_each(|m| m.check().unwrap());
    scene
}

fn mesh(text: &str) -> Mesh {
    Mesh::clone(&read(text).meshes[0])
}

fn refusal(text: &str) -> String {
    load(text.as_bytes(), "t.obj", &NoFiles, &Workers::single()).unwrap_err().to_string()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn a_polygon_keeps_its_outline() {
    let m = mesh(&format!("{SQUARE}f 1 2 3 4\nf 1 2 -1"));
    assert_eq!(
        m.faces,
        Faces::Polygons { starts: vec![0, 4, 7], corners: vec![0, 1, 2, 3, 0, 1, 3] }
    );
    assert_eq!(m.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 3]]);
    assert!(m.normals.is_none() && m.uvs.is_empty() && m.smoothing_groups.is_none());
}

#[test]
fn attributes_have_indices_of_their_own_only_where_they_differ() {
    let corners =
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1";
    let m = mesh(&format!("{SQUARE}{corners}"));
    assert_eq!(m.uvs[0].corners, None);
    assert_eq!(m.uvs[0].values, [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
    assert_eq!(m.normals.unwrap().corners, Some(vec![[0; 3]; 2]));
}

#[test]
fn gaps_in_attributes_are_filled() {
    let m = mesh(&format!("{SQUARE}vt .5 .5\nvn 1 0 0\nf 1/1/1 2/1/1 3/1/1\nf 1 3 4"));
    let (uv, normals) = (&m.uvs[0], m.normals.as_ref().unwrap());
    assert_eq!((uv.at(0, &m.triangles), uv.at(1, &m.triangles)), ([[0.5; 2]; 3], [[0.0; 2]; 3]));
    assert_eq!(normals.at(1, &m.triangles), [[0.0, 0.0, 1.0]; 3]);
}

#[test]
fn groups_materials_and_smoothing_make_runs() {
    let m = mesh(&format!(
        "{SQUARE}o box\nf 1 2 3\nusemtl red\ng top\ns 1\nf 1 2 4\nusemtl red\nf 2 3 4\ns off\ng top\nf 1 3 4"
    ));
    let parts: Vec<_> = m.parts.iter().map(|p| (p.name.as_str(), p.triangles.clone())).collect();
    assert_eq!(parts, [("box", 0..1), ("top", 1..4)]);
    assert_eq!(m.smoothing_groups, Some(vec![0, 1, 1, 0]));
}

#[test]
fn lines_and_points_stand_free() {
    let m = mesh(&format!("{SQUARE}l 1 2/1 3\np 4 -1\n"));
    assert_eq!((m.lines, m.points, m.triangles.len()), (vec![[0, 1], [1, 2]], vec![3, 3], 0));
    let cloud = mesh("vn 0 0 1\nv 0 0 0\nvn 0 1 0\nv 1 1 1");
    assert_eq!((cloud.points, cloud.normals.unwrap().values.len()), (vec![0, 1], 2));
}

#[test]
fn lines_and_points_have_the_material_in_force() {
    let folder = Folder(&[("m.mtl", "newmtl a\nnewmtl b\n")]);
    let text = format!(
        "mtllib m.mtl\n{SQUARE}l 1 2\nusemtl a\nl 2 3 4\np 1\nusemtl b\nf 1 2 3\nl 4 1\nl 1 3\nusemtl none\nl 2 4\np 2 3\n\
        usemtl a\np 4\n"
    );
    for piece in [1, 40, PIECE] {
        let s =
            load_in_pieces(text.as_bytes(), "t.obj", &folder, &Workers::single(), piece).unwrap();
        let m = &s.meshes[0];
        m.check().unwrap();
        let names = |parts: &[vitral_scene::FreePart], count: usize| -> Vec<Option<String>> {
            let of = |i| vitral_scene::FreePart::material_of(parts, i);
            (0..count).map(|i| of(i).map(|m| s.materials[m as usize].name.clone())).collect()
        };
        let [a, b] = ["a", "b"].map(|n| Some(n.to_owned()));
        assert_eq!(
            names(&m.line_parts, m.lines.len()),
            [None, a.clone(), a.clone(), b.clone(), b, None]
        );
        assert_eq!(names(&m.point_parts, m.points.len()), [a.clone(), None, None, a]);
        assert_eq!(m.parts[0].material, Some(1));
        assert_eq!(
            s.warnings,
            ["t.obj: line 14: unknown material `none`; the default one is used"]
        );
    }
}

#[test]
fn vertex_colours_are_linear() {
    let m = mesh("v 0 0 0 1 0 0.5\nv 1 0 0\nv 0 1 0 0 1 0 1\nf 1 2 3");
    let colors = m.colors.unwrap().values;
    assert_eq!((colors[0][0], colors[1], colors[2]), (1.0, [1.0; 4], [0.0, 1.0, 0.0, 1.0]));
    assert!((colors[0][2] - 0.2140).abs() < 1e-4);
    let bytes = read("v 0 0 0 255 0 0\nv 1 0 0 0 255 0\nv 0 1 0 0 0 255\nf 1 2 3");
    assert_eq!(bytes.meshes[0].colors.as_ref().unwrap().values[1], [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(bytes.warnings, ["t.obj: vertex colours exceed 1 and are read as 0 to 255"]);
    let above = read("v 0 0 0 1.000001 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3");
    assert_eq!(above.meshes[0].colors.as_ref().unwrap().values[0], [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(above.warnings, ["t.obj: vertex colours exceed 1 and are clamped"]);
}

#[test]
fn oddities_are_told_with_their_line() {
    let s = read(&format!(
        "{SQUARE}f\nf 1 2\nv 3.1+e2 0 0\ncurv 0 1\nlod 3\nfoo\nusemtl none\nf 1 2 3\nmtllib a b.mtl"
    ));
    assert_eq!(
        s.warnings,
        [
            "t.obj: line 5: a face with 0 corners, three are required; it is left out (and 1 more of the kind)",
            "t.obj: line 7: ill-formed number; only its beginning counts",
            "t.obj: line 8: free-form curves and surfaces are not read",
            "t.obj: line 9: `lod` is not used",
            "t.obj: line 10: unknown statement `foo`",
            "t.obj: line 13: material library `a b.mtl` is left out: there is no such file",
            "t.obj: line 11: unknown material `none`; the default one is used",
        ]
    );
    assert_eq!(s.meshes[0].positions[4][0], 3.1);
}

#[test]
fn attributes_that_lead_nowhere_are_left_out() {
    // None of them is there: as if none were named.
    let s = read(&format!("{SQUARE}f 1/1/1 2/2/1 3/3/1 4/4/1"));
    assert_eq!(
        s.warnings,
        [
            "t.obj: line 5: index 1, the file has 0 texture coordinates; left out (and 3 more of the kind)",
            "t.obj: line 5: index 1, the file has 0 normals; left out (and 3 more of the kind)",
        ]
    );
    assert!(s.meshes[0].uvs.is_empty() && s.meshes[0].normals.is_none());

    // Some are: faces with others have their own normal.
    let text = format!(
        "{SQUARE}vt .5 .5\nvn 1 0 0\nf 1/1/1 2/1/1 3/-2/1\nf 1/1/1 3/1/0 4/1/1\nf 1/1/1 3/1/1 4/1/1 2/1/2"
    );
    for piece in [1, 60, PIECE] {
        let s =
            load_in_pieces(text.as_bytes(), "t.obj", &NoFiles, &Workers::single(), piece).unwrap();
        let m = &s.meshes[0];
        m.check().unwrap();
        let (uv, normals) = (&m.uvs[0], m.normals.as_ref().unwrap());
        assert_eq!(uv.at(0, &m.triangles), [[0.5; 2], [0.5; 2], [0.0; 2]]);
        assert_eq!(normals.at(0, &m.triangles), [[1.0, 0.0, 0.0]; 3]);
        assert_eq!(
            normals.at(1, &m.triangles),
            [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
        );
        let last = [normals.at(2, &m.triangles), normals.at(3, &m.triangles)];
        assert_eq!(
            last.as_flattened().iter().filter(|n| **n != [1.0, 0.0, 0.0]).count(),
            1,
            "{last:?}"
        );
        let told = [
            "line 8: normal index 0: indices begin with 1, or count back from -1; left out",
            "line 7: the index counts back 1 texture coordinates beyond the first; left out",
            "line 9: index 2, the file has 1 normals; left out",
        ];
        assert_eq!(s.warnings, told.map(|w| format!("t.obj: {w}")));
    }
}

#[test]
fn elements_with_vertices_that_are_not_there_are_left_out() {
    let text = format!(
        "{SQUARE}vt 0 0\nvn 0 0 1\ng a\nf 1 2 3\ng b\nf 1/1/1 2/1/1 9/1/1\nf 1 2 3 4\ng c\nf 1 2 0\ns 1\nf 2 3 4\nl 1 2 7 3\np -9 4\n"
    );
    for piece in [1, 60, PIECE] {
        let s =
            load_in_pieces(text.as_bytes(), "t.obj", &NoFiles, &Workers::single(), piece).unwrap();
        let m = &s.meshes[0];
        m.check().unwrap();
        let parts: Vec<_> =
            m.parts.iter().map(|p| (p.name.as_str(), p.triangles.clone())).collect();
        assert_eq!(parts, [("a", 0..1), ("b", 1..3), ("c", 3..4)]);
        assert_eq!(
            (&m.smoothing_groups, m.uvs.len(), m.normals.is_none()),
            (&Some(vec![0, 0, 1]), 0, true)
        );
        assert_eq!((&m.lines, &m.points), (&vec![[0, 1]], &vec![3]));
        let told = "2 faces, 2 lines, 1 point with vertices that are not there are left out";
        assert_eq!(
            s.warnings,
            [format!("t.obj: line 10: index 9, the file has 4 vertices; {told}")]
        );
    }
    let one = read(&format!("{SQUARE}f 0 1 2\nf 1 2 3"));
    assert!(
        one.warnings[0].ends_with("; 1 face with vertices that are not there is left out"),
        "{:?}",
        one.warnings
    );
}

#[test]
fn files_without_a_sound_element_are_refused() {
    assert_eq!(
        refusal(&format!("{SQUARE}\nf 1 2 5")),
        "t.obj: line 6: index 5, the file has 4 vertices"
    );
    assert!(
        refusal(&format!("{SQUARE}f 1 2 -5"))
            .starts_with("t.obj: line 5: the index counts back 1 vertices")
    );
    assert!(
        refusal(&format!("{SQUARE}f 1 2 0"))
            .starts_with("t.obj: line 5: vertex index 0: indices begin with 1")
    );
    assert_eq!(
        refusal(&format!("{SQUARE}f 1 2 9\nf 1 x 2")),
        "t.obj: line 6: `x` is not a vertex index"
    );
    assert_eq!(
        refusal(&format!("{SQUARE}f 1 x 2\nf 1 2 9")),
        "t.obj: line 5: `x` is not a vertex index"
    );
    assert_eq!(
        refusal(&format!("{SQUARE}l 1 9\n l 3 7")),
        "t.obj: line 5: index 9, the file has 4 vertices"
    );
    assert_eq!(refusal("v 1 2"), "t.obj: line 1: a vertex has 2 coordinates, three are required");
    assert_eq!(
        refusal("v 1 2 # 3"),
        "t.obj: line 1: a vertex has 2 coordinates, three are required"
    );
    assert_eq!(refusal("v a b c"), "t.obj: line 1: `a` is not a number, a vertex needs three");
    assert_eq!(refusal("v 1 2 c"), "t.obj: line 1: `c` is not a number, a vertex needs three");
    assert_eq!(refusal("vn 1 x 2"), "t.obj: line 1: `x` is not a number, a normal needs three");
    assert_eq!(
        refusal("vt x"),
        "t.obj: line 1: `x` is not a number, a texture coordinate needs one"
    );
    for huge in ["99999999999", "-99999999999999999999999"] {
        assert_eq!(
            refusal(&format!("{SQUARE}f 1 2 {huge}/4")),
            format!("t.obj: line 5: vertex index {huge}: a file has at most 2147483648 of a kind")
        );
    }
    assert_eq!(refusal("# c\nhello world"), "t.obj: line 2: no statement of an OBJ file");
}

#[test]
fn text_may_come_in_many_ways() {
    let plain = mesh(&format!("{SQUARE}f 1 2 3 4\n"));
    assert_eq!(mesh(&format!("\u{feff}{SQUARE}f 1 2 3 4").replace('\n', "\r\n")), plain);
    assert_eq!(mesh(&format!("{SQUARE}f 1 2 \\\n 3 \\\r\n 4 # end")), plain);
    let wide: Vec<u8> =
        format!("\u{feff}{SQUARE}f 1 2 3 4").encode_utf16().flat_map(u16::to_be_bytes).collect();
    assert_eq!(*load(&wide, "t.obj", &NoFiles, &Workers::single()).unwrap().meshes[0], plain);
}

#[test]
fn libraries_with_paths_of_other_machines_lie_beside_the_file() {
    let folder = Folder(&[("my lib.mtl", "newmtl a\nKd 1 0 0")]);
    let text = format!("mtllib C:\\models\\my lib.mtl\n{SQUARE}usemtl a\nf 1 2 3");
    let s = load(text.as_bytes(), "t.obj", &folder, &Workers::single()).unwrap();
    assert_eq!((s.materials.len(), s.warnings.len()), (1, 0), "{:?}", s.warnings);
}

#[test]
fn names_of_libraries_may_have_blanks_behind_backslashes() {
    let folder = Folder(&[("my own lib.mtl", "newmtl a"), ("b.mtl", "newmtl b")]);
    for (line, missing) in
        [("my\\ own\\ lib.mtl", 1), ("b.mtl my\\ own\\ lib.mtl", 0), ("\"my own lib.mtl\"", 1)]
    {
        let text = format!("mtllib {line}\n{SQUARE}usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4");
        let s = load(text.as_bytes(), "t.obj", &folder, &Workers::single()).unwrap();
        assert_eq!(
            (s.materials.len(), s.warnings.len()),
            (2 - missing, missing),
            "{line}: {:?}",
            s.warnings
        );
    }
}

#[test]
fn comments_are_no_part_of_names() {
    let folder = Folder(&[(
        "m.mtl",
        "newmtl red one # x\nKd 1 0 0\nnewmtl Material #25\nnewmtl green # y\nmap_Kd gone.png # z",
    )]);
    let text = format!(
        "mtllib m.mtl # library\n{SQUARE}g a#b # c\nusemtl red one\nf 1 2 3\nusemtl red one # again\nf 1 3 4\n\
        usemtl Material #25\nf 1 2 4\nusemtl green # y\nf 2 3 4\nusemtl Material #26 # none\nf 2 4 1"
    );
    let s = load(text.as_bytes(), "t.obj", &folder, &Workers::single()).unwrap();
    let names: Vec<&str> = s.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["red one", "Material #25", "green # y"]);
    let parts: Vec<_> = s.meshes[0].parts.iter().map(|p| (p.name.as_str(), p.material)).collect();
    assert_eq!(parts[0], ("a#b", Some(0)));
    assert_eq!(
        parts.iter().filter_map(|p| p.1).collect::<std::collections::BTreeSet<_>>().len(),
        3,
        "{parts:?}"
    );
    assert!(
        s.warnings[0].contains("unknown material `Material #26 # none`") && s.warnings.len() == 2,
        "{:?}",
        s.warnings
    );
}

/// Files by name.
struct Folder(&'static [(&'static str, &'static str)]);

impl Resolver for Folder {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        let file = self.0.iter().find(|(name, _)| *name == path).ok_or(ResolveError::NotFound)?;
        Ok(file.1.as_bytes().to_vec())
    }
}

#[test]
fn the_only_material_of_the_library_is_used_where_none_is_chosen() {
    let folder = Folder(&[("one.mtl", "newmtl a\nKd 1 0 0"), ("two.mtl", "newmtl b\nnewmtl c")]);
    let materials = |library: &str, more: &str| {
        let text = format!("mtllib {library}\n{SQUARE}{more}f 1 2 3\nl 1 2\n");
        let s = load(text.as_bytes(), "t.obj", &folder, &Workers::single()).unwrap();
        s.meshes[0].check().unwrap();
        (s.meshes[0].parts[0].material, s.meshes[0].line_parts.len(), s.materials.len())
    };
    assert_eq!(materials("one.mtl", ""), (Some(0), 1, 1));
    assert_eq!(materials("two.mtl", ""), (None, 0, 0));
    assert_eq!(materials("one.mtl two.mtl", ""), (None, 0, 0));
    assert_eq!(materials("one.mtl", "usemtl none\n"), (None, 0, 0));
}

#[test]
fn a_model_far_away_keeps_its_shape() {
    let near = mesh("v 0.25 0 0\nv 1 0 0\nv 0 1.125 0\nf 1 2 3");
    let text =
        "v 10000000.25 0 4500000\nv 10000001 0 4500000 # c\nv 10000000,0 \\\n1.125 45.0D5\nf 1 2 3";
    for piece in [1, PIECE] {
        let s =
            load_in_pieces(text.as_bytes(), "t.obj", &NoFiles, &Workers::single(), piece).unwrap();
        let world = vitral_scene::World::new(&s).unwrap();
        let corners = world.corners_of_facet(0).map(|c| c.to_array());
        assert_eq!(
            corners,
            [[10_000_000.25, 0.0, 4.5e6], [10_000_001.0, 0.0, 4.5e6], [1e7, 1.125, 4.5e6]]
        );
        assert!(
            s.meshes[0].positions.as_flattened().iter().all(|c| c.abs() < 8.0),
            "{:?}",
            s.meshes[0].positions
        );
        assert_eq!((&s.meshes[0].triangles, s.warnings.len()), (&near.triangles, 0));
    }
}

#[test]
fn colours_of_zbrush_belong_to_the_vertices_in_order() {
    let text = format!("{SQUARE}#MRGB ffFF0000ff00ff00\n#MRGB 000000ffffffffff\nf 1 2 3 4\n");
    for piece in [1, 60, PIECE] {
        let s =
            load_in_pieces(text.as_bytes(), "t.obj", &NoFiles, &Workers::single(), piece).unwrap();
        let colors = s.meshes[0].colors.as_ref().unwrap();
        let expected = [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0], [1.0; 4]];
        assert_eq!((colors.values.as_slice(), s.warnings.len()), (&expected[..], 0));
    }
    let few = read(&format!("{SQUARE}#MRGB ffff0000\nf 1 2 3"));
    assert!(
        few.meshes[0].colors.is_none()
            && few.warnings[0].contains("1 colours (#MRGB) for 4 vertices")
    );
}

#[test]
fn materials_come_from_all_libraries() {
    let folder = Folder(&[
        ("sub/my lib.mtl", "newmtl a b\nKd 1 0 0\nmap_Kd gone.png"),
        ("two.mtl", "newmtl c\nKd 0 1 0\nnewmtl unused"),
    ]);
    let text = format!(
        "mtllib sub\\my lib.mtl\nmtllib one.mtl two.mtl\n{SQUARE}usemtl c\nf 1 2 3\nusemtl a b\nf 1 3 4"
    );
    let s = load(text.as_bytes(), "t.obj", &folder, &Workers::single()).unwrap();
    let kd = |i: usize| match s.materials[i].reflectance {
        Reflectance::Phong { kd, .. } => kd,
        other => panic!("{other:?}"),
    };
    assert_eq!((s.materials.len(), kd(0), kd(1)), (2, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]));
    assert_eq!(
        s.meshes[0].parts.iter().map(|p| p.material).collect::<Vec<_>>(),
        [Some(0), Some(1)]
    );
    assert_eq!(
        s.warnings,
        [
            "t.obj: line 2: material library `one.mtl` is left out: there is no such file",
            "sub/my lib.mtl: line 3: texture `gone.png` is left out: there is no such file",
        ]
    );
}

#[test]
fn names_in_latin_1_are_told_apart_and_found() {
    struct Latin;
    impl Resolver for Latin {
        fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
            match path {
                "é.mtl" => Ok(b"newmtl M\xE9tal\nmap_Kd T\xFCr.png\nnewmtl M\xE8tal\n".to_vec()),
                "utf8.mtl" => Ok("newmtl Öl\n".as_bytes().to_vec()),
                _ => Err(ResolveError::NotFound),
            }
        }
    }
    let start = format!("mtllib \\\n utf8.mtl\n{SQUARE}");
    let text =
        b"mtllib \xE9.mtl\ng T\xFCr\nusemtl M\xE9tal\nf 1 2 3\nusemtl M\xE8tal\nf 1 3 4\nusemtl \xD6l\nf 1 2 4\n";
    let s = load(&[start.as_bytes(), text].concat(), "t.obj", &Latin, &Workers::single()).unwrap();
    assert_eq!(
        s.materials.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(),
        ["Métal", "Mètal", "Öl"]
    );
    assert_eq!((s.meshes[0].parts.len(), s.meshes[0].parts[0].name.as_str()), (3, "Tür"));
    assert_eq!(s.warnings, ["é.mtl: line 2: texture `Tür.png` is left out: there is no such file"]);
}

#[test]
fn library_names_with_blanks_may_stand_between_quotes() {
    let folder = Folder(&[("m 3.mtl", "newmtl a"), ("m.mtl", "newmtl b"), ("n 1.mtl", "newmtl c")]);
    let text = format!(
        "mtllib \"m 3.mtl\" m.mtl n\\ 1.mtl\n{SQUARE}usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl c\nf 1 2 4"
    );
    let s = load(text.as_bytes(), "t.obj", &folder, &Workers::single()).unwrap();
    assert_eq!((s.materials.len(), s.warnings.len()), (3, 0), "{:?}", s.warnings);
    let s = read("mtllib \"none 1.mtl\" none.mtl\nv 0 0 0\n");
    let told = |name| {
        format!("t.obj: line 1: material library `{name}` is left out: there is no such file")
    };
    assert_eq!(s.warnings, [told("none 1.mtl"), told("none.mtl")]);
}

#[test]
fn every_statement_may_go_over_lines() {
    let s = read(
        "v 0 0 0\nv 1 0\\\n0\nv 1 1\\\r\n 0\ncurv 0 1 1 \\\n 2\nlod \\\n3\ng a b \\\nl r\nf 1 2\\\n 3\n# no \\\nf 3 2 1\nvx",
    );
    let mesh = &s.meshes[0];
    assert_eq!(mesh.positions, [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(
        (mesh.triangles.len(), mesh.parts.len(), mesh.parts[0].name.as_str()),
        (2, 1, "a b l r")
    );
    let told =
        ["line 6: free-form curves and", "line 8: `lod` is not", "line 16: unknown statement `vx`"];
    assert_eq!(s.warnings.len(), told.len(), "{:?}", s.warnings);
    assert!(s.warnings.iter().zip(told).all(|(w, t)| w.contains(t)), "{:?}", s.warnings);
}

#[test]
fn a_file_without_anything_is_an_empty_scene() {
    let s = read("# nothing\n");
    assert!(s.meshes.is_empty());
    assert_eq!(s.warnings, ["t.obj: the file holds nothing to show"]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Pieces of any size give the same scene, and the same error.
    #[test]
    fn pieces_do_not_show(
        lines in proptest::collection::vec(
            prop_oneof![
                4 => (any::<i8>(), any::<i8>()).prop_map(|(x, y)| format!("v {x} {y} 0.5")),
                2 => any::<i8>().prop_map(|x| format!("vt {x} 1")),
                1 => Just("vn 0 0 1".to_owned()),
                4 => proptest::collection::vec(prop_oneof![-6i32..0, 1i32..9], 0..6)
                    .prop_map(|c| format!("f{}", c.iter().map(|i| format!(" {i}")).collect::<String>())),
                2 => (-3i32..0, -3i32..0, -2i32..0).prop_map(|(a, b, c)| format!("f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}")),
                1 => (0u32..3).prop_map(|g| format!("s {g}")),
                1 => (0u32..3).prop_map(|g| format!("g {g}")),
                1 => (0u32..3).prop_map(|g| format!("usemtl m{g}")),
                1 => Just("l -1 -2".to_owned()),
            ],
            0..60,
        ),
        piece in 1usize..200,
    ) {
        let text = format!("{SQUARE}vt 0 0\nvn 1 0 0\n{}", lines.join("\n"));
        let whole = load(text.as_bytes(), "t.obj", &NoFiles, &Workers::single());
        let pieces = load_in_pieces(text.as_bytes(), "t.obj", &NoFiles, &Workers::single(), piece);
        match (whole, pieces) {
            (Ok(a), Ok(b)) => {
                a.meshes[0].check().unwrap();
                prop_assert_eq!(&a.meshes, &b.meshes);
                prop_assert_eq!(a.warnings, b.warnings);
            }
            (a, b) => prop_assert_eq!(a.map(|_| ()), b.map(|_| ())),
        }
    }
}
