//! Meshes between the scene file's form and ours.
//!
//! `triangles` alone are triangular faces. `faces` alone are polygons, cut as everywhere else. Both
//! together say how the polygons are cut, so that any mesh can be written down and read back equal.

use super::form::{AttributeForm, Coordinate, FreePartForm, MeshForm, PartForm};
use crate::polygons;
use vitral_exec::Workers;
use vitral_scene::{Attribute, Corners, Faces, FreePart, Mesh, Part};

/// Makes a mesh of its form; the error says what does not fit.
pub(super) fn from_form(form: MeshForm, workers: &Workers) -> Result<Mesh, String> {
    // Take the arrays as they are.
    let positions: Vec<[f32; 3]> = form.positions.into_iter().map(|p| p.map(|c| c.0)).collect();
    let (faces, triangles) = surfaces(&positions, form.faces, form.triangles, workers)?;
    let mut mesh = Mesh {
        name: form.name,
        positions,
        faces,
        triangles,
        normals: form.normals.map(attribute),
        normals_stay: form.normals_stay,
        tangents: form.tangents.map(attribute),
        uvs: form.uvs.into_iter().map(attribute).collect(),
        colors: form.colors.map(attribute),
        colors_from_srgb: form.colors_from_srgb,
        lines: form.lines,
        points: form.points,
        smoothing_groups: form.smoothing_groups,
        ..Mesh::default()
    };

    // Divide the triangles into the given parts, or make them one part.
    mesh.parts = match form.parts {
        Some(_) if form.material.is_some() => return Err("either `parts` or `material`".to_owned()),
        Some(parts) => parts_of(&mesh, parts)?,
        None if mesh.triangles.is_empty() => Vec::new(),
        None => vec![Part {
            name: String::new(),
            triangles: 0..mesh.triangles.len() as u32,
            material: form.material,
        }],
    };

    // Divide the lines and points.
    if form.line_material.is_some() && (form.line_parts.is_some() || form.point_parts.is_some()) {
        return Err("either `line-material` or `line-parts` and `point-parts`".to_owned());
    }
    FreePart::extend(&mut mesh.line_parts, 0..mesh.lines.len(), form.line_material);
    FreePart::extend(&mut mesh.point_parts, 0..mesh.points.len(), form.line_material);
    free_parts(&mut mesh.line_parts, form.line_parts);
    free_parts(&mut mesh.point_parts, form.point_parts);

    // Check the mesh.
    if mesh.uvs.len() > 2 {
        return Err(format!(
            "{} sets of texture coordinates, at most 2 are possible",
            mesh.uvs.len()
        ));
    }
    mesh.check()?;
    Ok(mesh)
}

/// Faces and their triangles.
fn surfaces(
    positions: &[[f32; 3]],
    faces: Option<Vec<Vec<u32>>>,
    triangles: Option<Vec<Corners>>,
    workers: &Workers,
) -> Result<(Faces, Vec<Corners>), String> {
    let Some(polygons) = faces else {
        return Ok((Faces::Triangles, triangles.unwrap_or_default()));
    };
    if let Some(f) = polygons.iter().position(|p| p.len() < 3) {
        return Err(format!("face {f} has {} corners, at least 3 are needed", polygons[f].len()));
    }
    let corners = polygons.concat();
    if u32::try_from(corners.len()).is_err() {
        return Err(format!("{} corners, at most 4294967295 are read", corners.len()));
    }
    if let Some(&bad) = corners.iter().find(|&&c| c as usize >= positions.len()) {
        return Err(format!("a face has corner {bad}, there are {} positions", positions.len()));
    }
    let sizes: Vec<u32> = polygons.iter().map(|p| p.len() as u32).collect();
    match triangles {
        // The cut is given: keep it, and keep triangular polygons polygons.
        Some(triangles) => {
            let mut starts = vec![0u32];
            starts.extend(sizes.iter().scan(0, |end, size| {
                *end += size;
                Some(*end)
            }));
            Ok((Faces::Polygons { starts, corners }, triangles))
        }
        None => {
            let built = polygons::build(positions, &sizes, corners, workers);
            Ok((built.faces, built.triangles))
        }
    }
}

/// Runs of faces or triangles, one after the other.
fn parts_of(mesh: &Mesh, forms: Vec<PartForm>) -> Result<Vec<Part>, String> {
    let (mut parts, mut face, mut triangle) = (Vec::with_capacity(forms.len()), 0usize, 0u64);
    for (i, form) in forms.into_iter().enumerate() {
        let start = triangle;
        match (form.faces, form.triangles) {
            (Some(count), None) => {
                face += count as usize;
                if face > mesh.face_count() {
                    return Err(format!("part {i} ends at face {face} of {}", mesh.face_count()));
                }
                triangle = if face == 0 { 0 } else { mesh.face_triangles(face - 1).end as u64 };
            }
            (None, Some(count)) => triangle += u64::from(count),
            _ => return Err(format!("part {i} needs either `faces` or `triangles`, a number")),
        }
        if triangle > mesh.triangles.len() as u64 || triangle < start {
            return Err(format!(
                "part {i} ends at triangle {triangle} of {}",
                mesh.triangles.len()
            ));
        }
        parts.push(Part {
            name: form.name,
            triangles: start as u32..triangle as u32,
            material: form.material,
        });
    }
    Ok(parts)
}

/// Runs of lines or points, one after the other.
fn free_parts(parts: &mut Vec<FreePart>, forms: Option<Vec<FreePartForm>>) {
    let mut next = 0usize;
    for form in forms.into_iter().flatten() {
        // An end that no mesh can reach is refused when the mesh is checked.
        let end = next.saturating_add(form.count as usize).min(u32::MAX as usize);
        FreePart::extend(parts, next..end, form.material);
        next = end;
    }
}

fn attribute<T>(form: AttributeForm<T>) -> Attribute<T> {
    Attribute { values: form.values, corners: form.corners }
}

/// The form of a mesh.
pub(super) fn to_form(mesh: &Mesh) -> MeshForm {
    let faces = match &mesh.faces {
        Faces::Triangles => None,
        Faces::Polygons { .. } => {
            Some((0..mesh.face_count()).map(|f| mesh.face_corners(f).to_vec()).collect())
        }
    };
    let part = |p: &Part| PartForm {
        name: p.name.clone(),
        faces: None,
        triangles: Some(p.triangles.end - p.triangles.start),
        material: p.material,
    };
    MeshForm {
        name: mesh.name.clone(),
        positions: mesh.positions.iter().map(|p| p.map(Coordinate)).collect(),
        faces,
        triangles: (!mesh.triangles.is_empty()).then(|| mesh.triangles.clone()),
        parts: (!mesh.parts.is_empty()).then(|| mesh.parts.iter().map(part).collect()),
        normals: mesh.normals.as_ref().map(attribute_form),
        normals_stay: mesh.normals_stay,
        tangents: mesh.tangents.as_ref().map(attribute_form),
        uvs: mesh.uvs.iter().map(attribute_form).collect(),
        colors: mesh.colors.as_ref().map(attribute_form),
        colors_from_srgb: mesh.colors_from_srgb,
        lines: mesh.lines.clone(),
        points: mesh.points.clone(),
        line_parts: free_part_forms(&mesh.line_parts),
        point_parts: free_part_forms(&mesh.point_parts),
        smoothing_groups: mesh.smoothing_groups.clone(),
        ..MeshForm::default()
    }
}

fn free_part_forms(parts: &[FreePart]) -> Option<Vec<FreePartForm>> {
    let form = |p: &FreePart| FreePartForm {
        count: p.elements.end - p.elements.start,
        material: p.material,
    };
    (!parts.is_empty()).then(|| parts.iter().map(form).collect())
}

/// Values that JSON cannot say become 0.
fn attribute_form<const N: usize>(a: &Attribute<[f32; N]>) -> AttributeForm<[f32; N]> {
    let said = |v: &[f32; N]| v.map(|c| if c.is_finite() { c } else { 0.0 });
    AttributeForm { values: a.values.iter().map(said).collect(), corners: a.corners.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(json: &str) -> Result<Mesh, String> {
        from_form(serde_json::from_str(json).map_err(|e| e.to_string())?, &Workers::single())
    }

    #[test]
    fn polygons_are_cut_and_parts_counted_in_faces() {
        let mesh = read(
            r#"{"positions":[[0,0,0],[1,0,0],[1,1,0],[0,1,0],[2,0,0]],"faces":[[0,1,2,3],[1,4,2]],
            "parts":[{"faces":1,"material":3},{"name":"b","triangles":1}]}"#,
        )
        .unwrap();
        assert_eq!((mesh.face_count(), mesh.triangles.len()), (2, 3));
        assert_eq!(mesh.parts[0], Part { name: String::new(), triangles: 0..2, material: Some(3) });
        assert_eq!(mesh.parts[1].triangles, 2..3);
    }

    #[test]
    fn what_does_not_fit_is_told() {
        let positions = r#""positions":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]"#;
        for (rest, part) in [
            (r#""faces":[[0,1]]"#, "face 0 has 2 corners"),
            (r#""faces":[[0,1,9]]"#, "corner 9, there are 4"),
            (r#""triangles":[[0,1,4]]"#, "index 4, there are 4"),
            (r#""faces":[[0,1,2,3]],"triangles":[[0,1,2]]"#, "do not fit"),
            (
                r#""triangles":[[0,1,2]],"parts":[{"triangles":2}]"#,
                "part 0 ends at triangle 2 of 1",
            ),
            (
                r#""triangles":[[0,1,2]],"parts":[{"faces":1,"triangles":1}]"#,
                "either `faces` or `triangles`",
            ),
            (r#""triangles":[[0,1,2]],"parts":[]"#, "parts end at 0 of 1"),
            (r#""normals":{"values":[[1e39,0,0]]}"#, "number out of range"),
            (r#""normals":{"values":[[0,0,1]]}"#, "1 normals for 4 vertices"),
            (r#""points":[7]"#, "point 0: index 7"),
            (
                r#""lines":[[0,1]],"line-parts":[{"count":2,"material":0}]"#,
                "line parts end at 2 of 1",
            ),
            (
                r#""points":[0],"line-material":0,"point-parts":[{"count":1}]"#,
                "either `line-material` or",
            ),
        ] {
            let message = read(&format!("{{{positions},{rest}}}")).unwrap_err();
            assert!(message.contains(part), "{rest}: {message}");
        }
    }
}
