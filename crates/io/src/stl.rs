//! STL, the format of stereolithography: a soup of triangles, in ASCII or binary.
//!
//! A binary file is an 80-byte header, a 32-bit count and a record for each triangle (`binary`).
//! Headers that begin with `solid` exist, so the size decides: a file of exactly `84 + 50 n` bytes
//! is binary. An ASCII file is one or more `solid NAME … endsolid`, each of which becomes a part of
//! the one mesh (`ascii`).
//!
//! Corners at equal positions are welded (`weld`), since without shared vertices there are neither
//! edges nor smooth shading. Facet normals are left out: they follow from the corners and are wrong
//! in many files.
//!
//! In:   bytes. Out: one mesh in model space.
//! Cost: `O(bytes)`, welding included; records are read where they lie.
//! Source: \[STL\].

mod ascii;
mod binary;

use crate::format::stl_size::is_binary_size;
use crate::text::{Cursor, to_utf8};
use crate::{Error, Place};
use vitral_exec::Workers;
use vitral_scene::Scene;

/// Reads an STL file of either kind.
///
/// # Errors
/// [`Error::Malformed`] with the byte at which a binary file ends too early or stops making sense,
/// or the first line that is not STL in an ASCII one.
pub fn load(bytes: &[u8], file: &str, workers: &Workers) -> Result<Scene, Error> {
    let is_text = !is_binary_size(bytes) && is_ascii(bytes);
    if is_text { ascii::read(bytes, file, workers) } else { binary::read(bytes, file, workers) }
}

/// Text that begins with `solid` or, where that line is lost, with `facet`. Binary data that
/// happens to begin so has zero bytes early: in its count, its normals.
fn is_ascii(bytes: &[u8]) -> bool {
    let head = to_utf8(&bytes[..bytes.len().min(1024)]);
    let mut cursor = Cursor::new(&head);
    let begins =
        |word: &[u8]| word.eq_ignore_ascii_case(b"solid") || word.eq_ignore_ascii_case(b"facet");
    cursor.next_content() && begins(cursor.word()) && !head.contains(&0)
}

fn check_count(triangles: usize, file: &str) -> Result<(), Error> {
    if triangles <= u32::MAX as usize / 3 {
        return Ok(());
    }
    Err(Error::malformed(
        file,
        Place::File,
        format!("{triangles} triangles, at most 1431655765 can be read"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn binary_file(header: &[u8], triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for t in triangles {
            bytes.extend([0; 12]);
            bytes.extend(t.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    const TWO: [[[f32; 3]; 3]; 2] = [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-0.0, 1.0, 0.0]],
    ];

    fn facet(t: &[[f32; 3]; 3]) -> String {
        let v: String =
            t.iter().map(|p| format!("  VERTEX {} {} {:e}\n", p[0], p[1], p[2])).collect();
        format!("facet normal 0 0 nan\n outer loop\r\n{v} endloop endfacet\n")
    }

    fn read(bytes: &[u8]) -> Result<Scene, Error> {
        load(bytes, "t.stl", &Workers::single())
    }

    #[test]
    fn both_kinds_give_the_same_welded_mesh() {
        let from_binary = read(&binary_file(b"solid but binary", &TWO)).unwrap();
        let text = format!("solid a b\n{}{}endsolid a b\n", facet(&TWO[0]), facet(&TWO[1]));
        let from_text = read(text.as_bytes()).unwrap();
        let (a, b) = (&from_binary.meshes[0], &from_text.meshes[0]);
        a.check().unwrap();
        assert_eq!((&a.positions, &a.triangles), (&b.positions, &b.triangles));
        assert_eq!((a.positions.len(), &a.triangles), (4, &vec![[0, 1, 2], [1, 3, 2]]));
        assert_eq!(b.parts[0].name, "a b");
        assert!(from_binary.warnings.is_empty() && from_text.warnings.is_empty());
    }

    #[test]
    fn one_line_is_enough() {
        let text = format!(
            "solid a b {}endsolid a b solid c {}endsolid c",
            facet(&TWO[0]),
            facet(&TWO[1])
        );
        for end in ["", "\n", "\r\n"] {
            let scene =
                read(format!("{}{end}", text.replace(['\r', '\n'], " ")).as_bytes()).unwrap();
            let parts = &scene.meshes[0].parts;
            let parts: Vec<_> =
                parts.iter().map(|p| (p.name.as_str(), p.triangles.clone())).collect();
            assert_eq!((parts, scene.warnings), (vec![("a b", 0..1), ("c", 1..2)], vec![]));
        }
        // A name is a name, whatever it says.
        let named = format!("solid my facet\n{}endsolid my solid facet\n", facet(&TWO[0]));
        assert_eq!(read(named.as_bytes()).unwrap().meshes[0].parts[0].name, "my facet");
        let bare = format!("solid\n{}endsolid", facet(&TWO[0]).replace("0 0 nan", ""));
        assert_eq!(read(bare.as_bytes()).unwrap().meshes[0].triangles.len(), 1);
    }

    #[test]
    fn each_solid_is_a_part() {
        let text = format!(
            "solid a\n{}endsolid a\nsolid\nendsolid\nsolid c\n{}",
            facet(&TWO[0]),
            facet(&TWO[1])
        );
        let scene = read(text.as_bytes()).unwrap();
        let parts: Vec<_> =
            scene.meshes[0].parts.iter().map(|p| (p.name.as_str(), p.triangles.clone())).collect();
        assert_eq!(parts, [("a", 0..1), ("c", 1..2)]);
        assert_eq!(scene.warnings, ["t.stl: line 18: the file ends without `endsolid`"]);
    }

    #[test]
    fn broken_files_are_refused_with_their_place() {
        let refusal = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
        let whole = binary_file(b"x", &TWO);
        assert_eq!(
            refusal(&whole[..183]),
            "t.stl: byte 183: the file ends here: 2 triangles are announced, 1 are there"
        );
        assert!(refusal(&whole[..50]).starts_with("t.stl: byte 50: the file ends here: a binary"));
        let told = "t.stl: line 5: the file ends here, `vertex` or `endloop` is required";
        assert_eq!(refusal(b"solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2\n"), told);
        assert_eq!(
            refusal(b"solid\n vertex"),
            "t.stl: line 2: `vertex`, `facet` or `endsolid` is required"
        );
        assert_eq!(
            refusal(b"solid\nfacet normal 0 0 1\nouter loop\nvertex 1,2,3 4 5\n"),
            "t.stl: line 4: `1,2,3`, a coordinate is required"
        );
        let longer = [whole, vec![7; 60]].concat();
        assert_eq!(
            read(&longer).unwrap().warnings,
            ["t.stl: byte 184: 60 bytes after the last triangle are left out"]
        );
    }

    #[test]
    fn the_size_decides_where_the_count_is_wrong() {
        let mut bytes = binary_file(b"x", &TWO);
        for count in [0u32, 1, 3, 7_000_000, u32::MAX] {
            bytes[80..84].copy_from_slice(&count.to_le_bytes());
            let scene = read(&bytes).unwrap();
            let told = "triangles are announced, the 2 are read that the file has room for";
            assert_eq!(scene.meshes[0].triangles.len(), 2);
            assert_eq!(scene.warnings, [format!("t.stl: byte 80: {count} {told}")]);
        }

        // Data that are no numbers are no triangles.
        bytes[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
        let refusal = read(&bytes).unwrap_err().to_string();
        assert!(
            refusal.starts_with("t.stl: byte 134: 4294967295 triangles are announced"),
            "{refusal}"
        );
    }

    #[test]
    fn bytes_behind_facets_are_skipped() {
        let whole = binary_file(b"x", &TWO);
        let mut bytes = whole[..84].to_vec();
        for (record, more) in whole[84..].chunks(50).zip([&b"abc"[..], b""]) {
            bytes.extend(&record[..48]);
            bytes.extend((more.len() as u16).to_le_bytes());
            bytes.extend(more);
        }
        let scene = read(&bytes).unwrap();
        assert_eq!(scene.meshes[0], read(&whole).unwrap().meshes[0]);
        assert_eq!(scene.warnings, ["t.stl: attribute bytes behind the facets are skipped"]);
    }

    #[test]
    fn facets_have_the_colours_of_both_dialects() {
        let colored = |header: &[u8], bits: [u16; 2]| {
            let mut bytes = binary_file(header, &TWO);
            bytes[84 + 48..84 + 50].copy_from_slice(&bits[0].to_le_bytes());
            bytes[84 + 98..84 + 100].copy_from_slice(&bits[1].to_le_bytes());
            let scene = read(&bytes).unwrap();
            let mesh = &scene.meshes[0];
            mesh.check().unwrap();
            let colors = mesh.colors.as_ref().map(|c| [0, 1].map(|t| c.at(t, &mesh.triangles)[0]));
            (colors, scene.warnings.len())
        };
        let [red, blue, white] = [[1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0], [1.0; 4]];

        // VisCAM: bit 15 says that there is a colour, blue is lowest.
        assert_eq!(colored(b"viscam", [0x8000 | 31 << 10, 0x8000 | 31]), (Some([red, blue]), 0));
        assert_eq!(colored(b"viscam", [0, 0x8000 | 31]), (Some([white, blue]), 0));
        assert_eq!(colored(b"numbers", [1, 2]), (None, 1));

        // Magics: bit 15 says that the object's colour counts, red is lowest.
        let header = b"x COLOR=\0\0\xff\xff,MATERIAL=";
        assert_eq!(colored(header, [31, 0x8000]), (Some([red, blue]), 0));
        assert_eq!(colored(header, [0, 0]), (Some([blue, blue]), 0));
    }

    #[test]
    fn ascii_files_vary() {
        let corners = "vertex 0 0 0\nvertex 2 0 0\nvertex 2 2 0\n";
        let triangle = |text: String, warning: &str| {
            let scene = read(text.as_bytes()).unwrap_or_else(|e| panic!("{text}: {e}"));
            assert_eq!(scene.meshes[0].triangles.len(), 1, "{text}");
            assert!(
                scene.warnings.len() == 1 && scene.warnings[0].contains(warning),
                "{text}: {:?}",
                scene.warnings
            );
        };
        let (head, foot) = ("facet normal 0 0 1\nouter loop\n", "endloop\nendfacet\n");
        triangle(
            format!("solid\n{head}{corners}end loop\nendfacet\nendsolid\n"),
            "`end loop` is taken for `endloop`",
        );
        triangle(
            format!("solid\n{head}{corners}endloop\nend facet\nend solid a\n"),
            "(and 1 more of the kind)",
        );
        triangle(
            format!("# c\nsolid\n{head}{corners}{foot}# d\nendsolid\n"),
            "comments are no part",
        );
        triangle(
            format!("solid\n{head}{corners}endfacet\nendsolid\n"),
            "`endfacet` where `vertex` or `endloop` is due",
        );
        triangle(
            format!("solid\n{head}{corners}endloop\nendsolid\n"),
            "`endsolid` where `endfacet` is due",
        );
        triangle(
            format!("solid\nfacet normal 0 0 1\n{corners}{foot}endsolid\n"),
            "`vertex` where `outer loop` is due",
        );
        triangle(
            format!("solid\nouter loop\n{corners}{foot}endsolid\n"),
            "where `facet` or `endsolid` is due",
        );
        triangle(format!("{head}{corners}{foot}endsolid\n"), "`facet` where `solid` is due");
        triangle(
            format!("solid\n{head}{corners}{foot}{head}vertex 1 1"),
            "ends within its last facet; it is left out",
        );
        triangle(
            format!("solid\n{head}{corners}{foot}{head}{corners}"),
            "ends within its last facet; it is left out",
        );
        triangle(
            format!("solid\n{head}{corners}{foot}{head}vertex 1 1 0\n{foot}endsolid"),
            "a facet with 1 corners",
        );
        let four = read(format!("solid\n{head}{corners}vertex 0 2 0\n{foot}endsolid\n").as_bytes())
            .unwrap();
        assert_eq!(four.meshes[0].triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(four.warnings[0].contains("a facet with 4 corners"), "{:?}", four.warnings);
    }
}
