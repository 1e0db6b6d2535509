//! Scenes on which visible-surface algorithms go wrong.

use vitral::{DMat4, Mesh, Part, Scene};

type Corner = [f32; 3];

/// A scene of triangles, each a face.
fn scene(triangles: &[[Corner; 3]]) -> Scene {
    let count = triangles.len() as u32;
    let mesh = Mesh {
        positions: triangles.as_flattened().to_vec(),
        triangles: (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        parts: vec![Part { name: String::new(), triangles: 0..count, material: None }],
        ..Mesh::default()
    };
    let mut scene = Scene::default();
    scene.add_mesh(mesh, DMat4::IDENTITY);
    scene
}

fn quad([a, b, c, d]: [Corner; 4]) -> [[Corner; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// Three bars, each over the next and under the one before.
fn cyclic_triple() -> Scene {
    let bars = (0..3).flat_map(|k| {
        let (sin, cos) = [(0.0, 1.0), (0.866_025_4, -0.5), (-0.866_025_4, -0.5)][k];
        let turn = |x: f32, y: f32, z: f32| [cos * x - sin * y, sin * x + cos * y, z];
        quad([
            turn(-1.2, -0.6, -0.3),
            turn(1.2, -0.6, 0.3),
            turn(1.2, -0.3, 0.3),
            turn(-1.2, -0.3, -0.3),
        ])
    });
    scene(&bars.collect::<Vec<_>>())
}

/// `count` squares through one another.
fn interpenetrating(count: usize) -> Scene {
    let squares = [
        quad([[-1.0, -1.0, -0.5], [1.0, -1.0, 0.5], [1.0, 1.0, 0.5], [-1.0, 1.0, -0.5]]),
        quad([[-1.0, -0.8, 0.6], [1.0, -0.8, -0.6], [1.0, 0.8, -0.4], [-1.0, 0.8, 0.4]]),
        quad([[-0.9, -1.0, 0.7], [0.9, -1.0, 0.7], [0.9, 1.0, -0.7], [-0.9, 1.0, -0.7]]),
    ];
    scene(squares[..count].as_flattened())
}

/// The same square three times, once with the other diagonal, and a part of its plane.
fn coplanar() -> Scene {
    let [a, b, c, d] = [[-1.0, -1.0, 0.2], [1.0, -1.0, -0.2], [1.0, 1.0, 0.1], [-1.0, 1.0, 0.5]];
    let quads = [quad([a, b, c, d]), quad([b, c, d, a]), quad([a, b, c, d])];
    let inner = [a, b, c].map(|p| [p[0] * 0.5, p[1] * 0.5, p[2] * 0.5 + 0.05]);
    let mut triangles = quads.as_flattened().to_vec();
    triangles.push(inner);
    scene(&triangles)
}

/// A long edge on one side, three short ones on the other, and something behind to shine through.
fn t_junctions() -> Scene {
    let (low, high) = ([-1.0, -0.7, 0.1], [1.0, 0.6, -0.2]);
    let on = |t: f32| [0, 1, 2].map(|k| low[k] + (high[k] - low[k]) * t);
    let (top, bottom) = ([-0.9, 0.9, 0.0], [0.9, -0.9, 0.0]);
    let mut triangles = vec![[low, high, top]];
    triangles.extend(
        [0.0, 0.31, 0.77].into_iter().zip([0.31, 0.77, 1.0]).map(|(a, b)| [on(a), bottom, on(b)]),
    );
    triangles.push([[-3.0, -3.0, -1.0], [3.0, -3.0, -1.0], [0.0, 4.0, -1.0]]);
    scene(&triangles)
}

/// A fan of triangles thinner than a sample is from the next, across each other, some standing on
/// edge.
fn needles() -> Scene {
    let mut triangles = Vec::new();
    for i in 0..60u8 {
        let t = f32::from(i) / 30.0 - 1.0;
        let z = 0.4 * (t * 7.0).fract();
        triangles.push([[-1.3, t, z], [1.3, -t * 0.7, -z], [1.3, -t * 0.7 + 0.012, -z]]);
        triangles.push([[t, -1.3, -z], [-t * 0.9, 1.3, z], [-t * 0.9 + 0.003, 1.3, z]]);
        triangles.push([[t, 0.3, -2.0], [t, 0.300_001, 2.0], [t, 0.3, 2.0]]);
    }
    scene(&triangles)
}

/// A floor, a wall and a ceiling that run past the viewer, and faces before and behind.
fn through_the_eye() -> Scene {
    let mut triangles = Vec::new();
    triangles.extend(quad([
        [-9.0, -0.5, 9.0],
        [9.0, -0.5, 9.0],
        [9.0, -0.5, -9.0],
        [-9.0, -0.5, -9.0],
    ]));
    triangles.extend(quad([
        [0.7, -2.0, 9.0],
        [0.7, 2.0, 9.0],
        [0.7, 2.0, -9.0],
        [0.7, -2.0, -9.0],
    ]));
    triangles.extend(quad([
        [-9.0, 0.8, 9.0],
        [9.0, 0.9, 9.0],
        [9.0, 0.2, -9.0],
        [-9.0, 0.1, -9.0],
    ]));
    triangles.extend(quad([
        [-1.0, -1.0, 0.0],
        [1.0, -1.0, 0.3],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, -0.3],
    ]));
    triangles.push([[-2.0, 0.1, 20.0], [2.0, 0.3, -20.0], [0.0, -0.3, -2.0]]);
    scene(&triangles)
}

/// Thousands of triangles about as large as a pixel, in no order.
fn soup() -> Scene {
    let mut state = 12345u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32 * 2.0 - 1.0
    };
    let triangles: Vec<_> = (0..6000)
        .map(|_| {
            let center = [next(), next(), next()];
            [0; 3].map(|_| center.map(|c| c + next() * 0.04))
        })
        .collect();
    scene(&triangles)
}

/// All of them, by name.
pub(crate) fn all() -> Vec<(&'static str, Scene)> {
    vec![
        ("cyclic triple", cyclic_triple()),
        ("two interpenetrating", interpenetrating(2)),
        ("three interpenetrating", interpenetrating(3)),
        ("coplanar", coplanar()),
        ("T-junctions", t_junctions()),
        ("needles", needles()),
        ("through the eye", through_the_eye()),
        ("soup", soup()),
    ]
}
