use crate::{Lab, Message};
use serde_json::{Value, json};
use vitral::State;

/// The answer to a request, which must be one.
fn ask(lab: &mut Lab, request: Value) -> (Value, Vec<Vec<u8>>) {
    let answer = lab.answer(Message { json: request.to_string(), planes: Vec::new() });
    let told: Value = serde_json::from_str(&answer.json).unwrap();
    assert!(told["error"].is_null(), "{told}");
    (told["ok"].clone(), answer.planes)
}

fn error(lab: &mut Lab, request: Value) -> String {
    let answer = lab.answer(Message { json: request.to_string(), planes: Vec::new() });
    let told: Value = serde_json::from_str(&answer.json).unwrap();
    told["error"]["message"].as_str().unwrap_or_else(|| panic!("{told}")).to_owned()
}

fn small(model: &str, settings: Value) -> Value {
    let mut state = json!({"models": [model], "settings": {"width": 48, "height": 36}});
    for (name, value) in settings.as_object().unwrap() {
        state["settings"][name] = value.clone();
    }
    state
}

#[test]
fn the_catalog_has_all_that_can_be_chosen() {
    let (catalog, _) = ask(&mut Lab::default(), json!({"want": "catalog"}));
    assert_eq!(catalog["algorithms"], vitral::algorithms());
    for want in catalog["wants"].as_array().unwrap() {
        let answer = Lab::default()
            .answer(Message { json: json!({"want": want}).to_string(), planes: Vec::new() });
        assert!(!answer.json.contains("unknown variant"), "{}", answer.json);
    }
    assert_eq!(catalog["models"].as_array().unwrap().len(), vitral::builtin_names().len());
    let defaults: State = serde_json::from_value(catalog["defaults"].clone()).unwrap();
    assert_eq!(defaults, State::default());
}

#[test]
fn the_picture_is_the_renderers_byte_for_byte() {
    let state = small("builtin:cubs", json!({"shading": "gouraud", "visibility": "warnock"}));
    let (told, planes) = ask(&mut Lab::default(), json!({"want": "picture", "state": state}));
    let state = State::from_json(&state.to_string(), "s").unwrap();
    let mut renderer = vitral::Renderer::new(state.load_scene().unwrap()).unwrap();
    state.apply(&mut renderer).unwrap();
    assert_eq!(planes[0], renderer.render().unwrap().rgba8());
    assert_eq!(
        told["description"],
        "cubs seen from the default side, warnock, gouraud shading, 2 lights"
    );
    let counters = told["counters"].as_array().unwrap();
    let windows = counters.iter().find(|row| row["name"] == "visibility.windows").unwrap();
    assert!(
        windows["value"].as_u64().unwrap() > 0
            && windows["meaning"] == "Area subdivision: windows looked at."
    );
}

#[test]
fn every_algorithm_is_stepped_and_ends_with_the_picture() {
    let mut lab = Lab::default();
    for algorithm in vitral::Visibility::all() {
        let state = small("builtin:cubs", json!({"visibility": algorithm.name}));
        let (_, picture) = ask(&mut lab, json!({"want": "picture", "state": state}));
        let (told, _) = ask(&mut lab, json!({"want": "record", "state": state, "pixel": [24, 18]}));
        let steps = told["steps"].as_u64().unwrap();
        let counted: u64 =
            told["groups"].as_array().unwrap().iter().map(|g| g["count"].as_u64().unwrap()).sum();
        assert!(steps > 0 && counted == steps, "{} {told}", algorithm.name);

        // The last step shows what is left; any other is reached from there.
        let step = |number: u64| json!({"want": "step", "state": state, "number": number});
        let (last, end) = ask(&mut lab, step(steps));
        assert_eq!((&last["number"], &last["total"]), (&json!(steps), &json!(steps)));
        assert_eq!(end, picture, "{}", algorithm.name);
        let (first, begin) = ask(&mut lab, step(1));
        assert!(begin != end && !first["words"].as_str().unwrap().is_empty(), "{}", algorithm.name);
        assert!(first["drawing"].as_str().unwrap().starts_with("<svg"));
        assert!(error(&mut lab, step(steps + 1)).contains("there is no step"));

        // Every step is told in words, not as data.
        let (all, _) =
            ask(&mut lab, json!({"want": "steps", "state": state, "from": 1, "to": 20_000}));
        let words =
            all["steps"].as_array().unwrap().iter().map(|step| step["words"].as_str().unwrap());
        words.for_each(|words| {
            assert!(!words.contains('{') && words.len() > 5, "{}: {words}", algorithm.name)
        });
    }
}

#[test]
fn steps_of_a_group_and_of_a_pixel_are_fewer() {
    let mut lab = Lab::default();
    let state = small("builtin:cubs", json!({"visibility": "warnock"}));
    let (told, _) = ask(&mut lab, json!({"want": "record", "state": state, "pixel": [24, 18]}));
    let windows =
        told["groups"].as_array().unwrap().iter().find(|g| g["name"] == "window").unwrap()["count"]
            .clone();
    let step = |show: &str, number: u64| json!({"want": "step", "state": state, "number": number, "show": show, "pixel": [24, 18]});
    let (told_window, _) = ask(&mut lab, step("window", 1));
    assert_eq!((&told_window["total"], &told_window["group"]), (&windows, &json!("window")));
    let (at_pixel, _) = ask(&mut lab, step("pixel", 1));
    assert_eq!(at_pixel["total"], told["at-pixel"]);
    assert!(at_pixel["total"].as_u64() < windows.as_u64());
    assert!(error(&mut lab, step("line", 1)).contains("no steps `line`"));
    let many = json!({"want": "steps", "state": state, "from": 2, "to": 4, "show": "window"});
    let (many, _) = ask(&mut lab, many);
    let numbers: Vec<u64> =
        many["steps"].as_array().unwrap().iter().map(|s| s["number"].as_u64().unwrap()).collect();
    assert_eq!(numbers, [2, 3, 4]);
    assert_eq!((&many["total"], &many["steps"][0]["fields"]["path"]), (&windows, &json!("0")));
    let (structure, _) = ask(&mut lab, json!({"want": "structure", "state": state}));
    assert!(structure["drawing"].as_str().unwrap().contains("<svg"));
}

#[test]
fn the_scene_is_seen_from_outside_with_its_view_volume() {
    let mut lab = Lab::default();
    let state = small("builtin:scene0", json!({}));
    let (told, planes) = ask(&mut lab, json!({"want": "overview", "state": state}));
    let drawing = told["drawing"].as_str().unwrap();
    let volume =
        drawing.split("<g class=\"volume\">").nth(1).unwrap().split("</g>").next().unwrap();
    assert_eq!(volume.matches("<line").count(), 12);
    assert_eq!(drawing.matches("<g class=\"box kept\">").count(), 5);
    assert!(
        drawing.contains("class=\"eye\"") && drawing.contains("<title>LIGHT0</title>"),
        "{drawing}"
    );
    let (own, picture) = ask(&mut lab, json!({"want": "picture", "state": state}));
    assert!(
        own["width"] == told["width"] && planes[0].len() == picture[0].len() && planes != picture
    );
    let second = json!({"want": "overview", "state": state, "second": {"view": "top"}});
    assert_ne!(ask(&mut lab, second).1, planes);
}

#[test]
fn a_pixel_is_explained_with_its_formula_and_why() {
    let mut lab = Lab::default();
    let state = small("builtin:sphere", json!({"illumination": "phong"}));
    let (told, _) = ask(&mut lab, json!({"want": "explain", "state": state, "pixel": [24, 18]}));
    let why = told["why"].as_array().unwrap();
    assert!(why[0].as_str().unwrap().contains("is seen here"), "{why:?}");
    assert_eq!(why.len(), 3, "{why:?}");
    let mathml = told["formula"]["mathml"].as_str().unwrap();
    assert!(mathml.starts_with("<math") && mathml.contains("<mi mathvariant=\"bold\">R</mi>"));
    let values = told["formula"]["values"].as_array().unwrap();
    let bytes =
        values.iter().find(|row| row["symbol"] == "bytes").unwrap()["value"].as_str().unwrap();
    let (_, picture) = ask(&mut lab, json!({"want": "picture", "state": state}));
    let at = (18 * 48 + 24) * 4;
    assert_eq!(
        bytes,
        picture[0][at..at + 3].iter().map(u8::to_string).collect::<Vec<_>>().join(" ")
    );

    // Behind the sphere's edge there is nothing.
    let (nothing, _) = ask(&mut lab, json!({"want": "explain", "state": state, "pixel": [0, 0]}));
    assert_eq!(nothing["why"], json!(["No surface is here: the pixel shows the background."]));
    assert_eq!(nothing["formula"], Value::Null);
    let (all, _) = ask(&mut lab, json!({"want": "ask-all", "state": state, "pixel": [24, 18]}));
    let decisions = all["decisions"].as_array().unwrap();
    assert!(decisions.len() > 8 && decisions.iter().all(|d| d["facet"] == decisions[0]["facet"]));
}

#[test]
fn a_ray_tells_what_it_opens_of_each_structure() {
    let mut lab = Lab::default();
    for structure in vitral::algorithms()["acceleration"].as_array().unwrap() {
        let name = structure["name"].as_str().unwrap();
        let choice = json!({"visibility": "ray-cast", "acceleration": name});
        let state = small("builtin:cubs", choice);
        let request = |want: &str| json!({"want": want, "state": state, "pixel": [24, 18]});
        let (told, _) = ask(&mut lab, request("acceleration"));
        let (explained, _) = ask(&mut lab, request("explain"));
        assert_eq!(told["acceleration"], name);
        assert_eq!(told["hit"], explained["explanation"]["surfaces"][0]["facet"], "{told}");
        let parts = told["parts"].as_array().unwrap();
        assert_eq!((parts.is_empty(), told["space"].is_null()), (name == "none", name == "none"));
        assert_eq!(told["space"]["cells"].is_array(), name == "grid");
        let turned = parts.iter().filter_map(|part| part["volume"]["type"].as_str()).next();
        let expected = ["oriented-box", "sphere"].into_iter().find(|volume| *volume == name);
        assert_eq!(turned, expected, "{told}");
        for (position, part) in parts.iter().enumerate().filter(|(_, p)| !p["parent"].is_null()) {
            assert!(parts[..position].iter().any(|above| above["id"] == part["parent"]), "{told}");
        }
    }
    let state = small("builtin:cubs", json!({}));
    let outside = json!({"want": "acceleration", "state": state, "pixel": [48, 0]});
    assert!(error(&mut lab, outside).contains("there is no pixel"));
}

#[test]
fn algorithms_agree_and_defects_do_not() {
    let mut lab = Lab::default();
    let [a, b, c] = [
        json!({"visibility": "bsp"}),
        json!({"visibility": "painter"}),
        json!({"shading": "flat"}),
    ]
    .map(|settings| small("builtin:sphere", settings));
    let (same, planes) = ask(&mut lab, json!({"want": "compare", "state": a, "b": b}));
    assert_eq!((&same["agreement"]["differ"], planes.len()), (&json!(0), 3));
    let (other, _) = ask(&mut lab, json!({"want": "compare", "state": a, "b": c}));
    assert!(other["agreement"]["differ"].as_u64().unwrap() > 20);
    assert_eq!(other["agreement"]["first"].as_array().unwrap().len(), 20);
    let (all, _) = ask(&mut lab, json!({"want": "compare-all", "state": a}));
    let rows = all["rows"].as_array().unwrap();
    assert!(rows.iter().all(|row| row["differ"] == 0 && row["memory"] != 0), "{all}");
    assert_eq!((&rows[0]["algorithm"], &rows[0]["memory"]), (&json!("z-buffer"), &Value::Null));
}

#[test]
fn exercises_are_refused_at_first_and_passed_when_done() {
    let mut lab = Lab::default();
    let (catalog, _) = ask(&mut lab, json!({"want": "catalog"}));
    let edit = |light: &str, field: &str, value: &str| json!({"light": light, "field": field, "value": value});
    for exercise in catalog["exercises"].as_array().unwrap() {
        let (id, start) = (exercise["id"].as_str().unwrap(), &exercise["start"]);
        let mut check = |state: &Value, pixel: Option<[u32; 2]>| {
            ask(&mut lab, json!({"want": "check", "state": state, "exercise": id, "pixel": pixel}))
                .0
        };
        let refused = check(start, None);
        assert!(refused["passed"] == false, "{id}: {refused}");
        assert!(refused["message"].as_str().unwrap().starts_with("Not yet: "));

        let (mut done, mut pixel) = (start.clone(), None);
        let mut near_miss = None;
        match id {
            "4.1" => done["light-edits"] = json!([edit("LIGHT0", "enabled", "off")]),
            "4.2" => {
                done["light-edits"] = json!([
                    edit("LIGHT0", "ambient", "0"),
                    edit("LIGHT0", "specular", "0"),
                    edit("LIGHT0", "position", "-6,2,6"),
                ]);
            }
            "4.3" => done["settings"]["lighting"] = json!(false),
            "5.1" => {
                let green = json!({"name": "LIGHT2", "kind": {"type": "directional", "direction": [-1, 0, 0]},
                    "ambient": [0, 1, 0], "diffuse": [0, 1, 0], "specular": [0, 1, 0]});
                done["lights"].as_array_mut().unwrap().push(green);
            }
            "5.2" => done["load"]["normals"] = json!("none"),
            "P17" => done["settings"]["depth-bits"] = json!(8),
            "P7" => {
                done["settings"]["coherence"] =
                    json!(["object", "face", "scan-line", "area", "depth", "frame"])
            }
            "P8" => (pixel, near_miss) = (Some([340, 200]), Some([5, 5])),
            "P10" => done["viewpoint"]["zoom-factor"] = json!(10),
            "P14" => done["settings"]["cull"]["back-face"] = json!(true),
            "P19" => (pixel, near_miss) = (Some([320, 240]), Some([320, 2])),
            "P20" => (pixel, near_miss) = (Some([280, 150]), Some([2, 2])),
            "P21" => done["models"] = json!(["builtin:scene0"]),
            "P22" => done["viewpoint"]["azimuth-angle"] = json!(180),
            "L8" => {
                done["settings"]["shading"] = json!("gouraud");
                (done["load"]["normals"], done["load"]["crease-angle"]) =
                    (json!("made"), json!(2.0));
            }
            "L9" => {
                done["settings"]["shading"] = json!("gouraud");
                (pixel, near_miss) = (Some([130, 200]), Some([200, 200]));
            }
            "L20" => (pixel, near_miss) = (Some([222, 156]), Some([240, 240])),
            "P37" => {
                done["materials"] =
                    json!([{"material": "*", "property": "shininess", "value": "45"}])
            }
            "P40" => done["light-edits"] = json!([edit("LIGHT0", "attenuation", "0,0,0.1")]),
            other => panic!("{other} has no way to be done here"),
        }
        if near_miss.is_some() {
            let refused = check(&done, near_miss);
            assert!(refused["passed"] == false, "{id}: {refused}");
        }
        let passed = check(&done, pixel);
        assert!(passed["passed"] == true, "{id}: {passed}");
    }
}

#[test]
fn stages_info_and_texts_are_told() {
    let mut lab = Lab::default();
    let state = small("builtin:cubs", json!({}));
    let (told, _) = ask(&mut lab, json!({"want": "stages", "state": state, "pixel": [24, 18]}));
    let stages: Vec<&str> = told["stages"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["stage"].as_str().unwrap())
        .collect();
    assert_eq!((stages.len(), stages[0], stages[8]), (9, "scene graph", "frame buffer"));
    for space in ["model", "world", "view", "clip", "ndc", "screen"] {
        assert_eq!(told["spaces"][space].as_array().unwrap().len(), 3, "{space}: {told}");
    }
    let (info, _) = ask(&mut lab, json!({"want": "info", "state": state}));
    assert!(info["rows"].as_array().unwrap().iter().any(|row| row["name"] == "triangles"));
    let (complete, _) = ask(&mut lab, json!({"want": "complete", "state": state}));
    assert_eq!(complete["lights"].as_array().unwrap().len(), 2);
    let save = |what: &str| json!({"want": "save", "state": state, "what": what});
    let (drawing, _) = ask(&mut lab, save("drawing"));
    assert!(drawing["text"].as_str().unwrap().starts_with("<svg"));
    let (saved, _) = ask(&mut lab, save("state"));
    assert!(State::from_json(saved["text"].as_str().unwrap(), "s").is_ok());
}

#[test]
fn a_pixel_tells_its_projector_and_what_the_notes_misprint() {
    let mut lab = Lab::default();
    let mut state = small("builtin:cubs", json!({"width": 640, "height": 480}));
    state["light-edits"] =
        json!([{"light": "LIGHT0", "field": "attenuation", "value": "0,0,0.05"}]);
    let (told, _) = ask(&mut lab, json!({"want": "stages", "state": state, "pixel": [390, 200]}));
    assert_eq!(told["projector"].as_array().unwrap().len(), 2);

    // LIGHT0 is behind this face: the printed formula takes light away.
    let (told, _) = ask(&mut lab, json!({"want": "explain", "state": state, "pixel": [390, 200]}));
    let rows = told["printed"].as_array().unwrap();
    let find = |what: &str| {
        rows.iter().find(|row| row["what"] == what).unwrap_or_else(|| panic!("{what}: {told}"))
    };
    let behind = find("diffuse and specular light of LIGHT0");
    assert!(
        behind["right-value"] == 0.0 && behind["printed-value"].as_f64().unwrap() < 0.0,
        "{behind}"
    );
    assert_eq!(find("reflectance kd")["right-value"].as_f64().unwrap() as f32, 0.85);
    let far = find("attenuation of LIGHT0");
    assert!(far["right-value"].as_f64().unwrap() < 0.3 && far["printed-value"] == 1.0, "{far}");

    let (timed, _) = ask(
        &mut lab,
        json!({"want": "bench", "state": small("builtin:cubs", json!({})), "frames": 3}),
    );
    assert_eq!(timed["frames"], 3);
    assert!(
        error(
            &mut lab,
            json!({"want": "bench", "state": small("builtin:cubs", json!({})), "frames": 0})
        )
        .contains("cannot be timed")
    );
}

#[test]
fn depths_round_a_pixel_change_where_the_facet_of_the_step_stays() {
    let mut lab = Lab::default();
    let state = small("builtin:cubs", json!({"width": 640, "height": 480, "samples": 1}));
    let pixel = json!([340, 200]);
    let (recorded, _) = ask(&mut lab, json!({"want": "record", "state": state, "pixel": pixel}));
    let about = recorded["at-pixel"].as_u64().unwrap();
    assert!(about >= 2, "{recorded}");
    let mut before = vec![0.0; 81];
    for number in 1..=recorded["steps"].as_u64().unwrap() {
        let request = json!({"want": "step", "state": state, "number": number, "pixel": pixel});
        let (step, _) = ask(&mut lab, request);
        let numbers = |name: &str| -> Vec<f64> {
            serde_json::from_value(step["depths"][name].clone()).unwrap()
        };
        assert_eq!(numbers("before"), before, "step {number}");
        before = numbers("after");
        assert!(numbers("before").iter().zip(&before).all(|(before, after)| before <= after));
        assert_eq!((&step["depths"]["x"], &step["depths"]["y"]), (&json!(336), &json!(196)));
    }
    // The last is the picture's depth.
    let (told, _) = ask(&mut lab, json!({"want": "explain", "state": state, "pixel": pixel}));
    assert_eq!(
        told["explanation"]["surfaces"][0]["depth"].as_f64().unwrap() as f32,
        before[40] as f32
    );

    let brute = small("builtin:cubs", json!({"visibility": "brute-force"}));
    let (step, _) =
        ask(&mut lab, json!({"want": "step", "state": brute, "number": 1, "pixel": [24, 18]}));
    assert!(!step["depths"]["facets"].as_array().unwrap().is_empty());
}

#[test]
fn mistakes_are_told_and_the_next_request_works() {
    let mut lab = Lab::default();
    assert!(error(&mut lab, json!({"want": "tea"})).contains("unknown variant `tea`"));
    let told =
        error(&mut lab, json!({"want": "picture", "state": {"settings": {"visiblity": "bsp"}}}));
    assert!(told.contains("settings") && told.contains("visiblity"), "{told}");
    assert!(
        error(&mut lab, json!({"want": "picture", "state": {"models": ["x.obj"]}}))
            .contains("no such model")
    );
    let told = lab.answer(Message { json: "{".to_owned(), planes: Vec::new() });
    assert!(told.json.contains("cannot be read"));
    ask(&mut lab, json!({"want": "picture", "state": small("builtin:cubs", json!({}))}));
}

#[test]
fn own_files_are_models() {
    let mut lab = Lab::default();
    let file = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n".to_vec();
    let request = json!({"want": "files", "files": [{"name": "t.obj"}]});
    let told = lab.answer(Message { json: request.to_string(), planes: vec![file] });
    let told: Value = serde_json::from_str(&told.json).unwrap();
    let hash = told["ok"]["files"][0]["hash"].as_str().unwrap();
    let (picture, _) = ask(
        &mut lab,
        json!({"want": "picture", "state": small(&format!("file:t.obj#{hash}"), json!({}))}),
    );
    assert_eq!(picture["facts"]["triangles"], 1);
}

#[test]
fn facets_tell_what_they_belong_to_and_where_they_are() {
    let mut lab = Lab::default();
    let state = small("builtin:cubs", json!({}));
    let (told, _) = ask(&mut lab, json!({"want": "facets", "state": state, "facets": [0, 1, 5]}));
    let facets = told["facets"].as_array().unwrap();
    assert_eq!(facets.len(), 3);
    assert_eq!([&facets[0]["surface"], &facets[1]["surface"]], [0, 0], "two halves of a square");
    let outlines = facets.iter().map(|facet| facet["outline"].as_array().unwrap().len());
    assert!(outlines.clone().any(|corners| corners >= 3), "{told}");
    let far = json!({"want": "facets", "state": state, "facets": [100_000]});
    assert!(error(&mut lab, far).contains("no facet 100000"));
}

#[test]
fn l20_a_highlight_lies_where_its_light_is_mirrored() {
    let mut lab = Lab::default();
    let mut state = small("builtin:sphere", json!({"width": 160, "height": 120}));
    let (told, _) = ask(&mut lab, json!({"want": "highlight", "state": state, "light": 0}));
    let [centroid, mirror] = ["centroid", "mirror"]
        .map(|name| [0, 1].map(|k| told[name][k].as_f64().unwrap_or_else(|| panic!("{told}"))));
    let apart = (centroid[0] - mirror[0]).hypot(centroid[1] - mirror[1]);
    assert!(apart < 6.0, "{told}");

    // Ambient light comes from nowhere.
    state["lights"] = json!([{"name": "LIGHT0", "kind": {"type": "ambient"}}]);
    let (told, _) = ask(&mut lab, json!({"want": "highlight", "state": state, "light": 0}));
    assert!(told["mirror"].is_null() && told["centroid"].is_null(), "{told}");
    let none = json!({"want": "highlight", "state": state, "light": 9});
    assert!(error(&mut lab, none).contains("no light 9"));
}

#[test]
fn steps_about_polygons_show_their_outlines() {
    let mut lab = Lab::default();
    let shapes = |lab: &mut Lab, algorithm: &str, group: &str| {
        let state = small("builtin:cubs", json!({"visibility": algorithm}));
        let (told, _) = ask(lab, json!({"want": "record", "state": state}));
        let groups = told["groups"].as_array().unwrap();
        let count = groups.iter().find(|g| g["name"] == group).unwrap()["count"].as_u64().unwrap();
        let step = |number: u64| {
            let step = json!({"want": "step", "state": state, "number": number, "show": group});
            ask(lab, step).0["drawing"].as_str().unwrap().to_owned()
        };
        (1..=count).map(step).collect::<String>()
    };
    let compared = shapes(&mut lab, "painter", "compared");
    for class in ["\"p\"", "\"q\"", "\"extent p\"", "\"extent q\""] {
        assert!(compared.contains(&format!("class={class}")), "{class} in {compared}");
    }
    assert!(shapes(&mut lab, "bsp", "tree-node").contains(r#"class="splitter""#));
    assert!(shapes(&mut lab, "weiler-atherton", "clip").contains(r#"class="clip" data-facet="#));
}

#[test]
fn the_second_view_shows_the_rays_of_a_pixel_and_planes_of_a_tree() {
    let mut lab = Lab::default();
    let state = small("builtin:cubs", json!({"visibility": "bsp"}));
    ask(&mut lab, json!({"want": "record", "state": state}));
    let (first, _) =
        ask(&mut lab, json!({"want": "step", "state": state, "number": 1, "show": "tree-node"}));
    let request =
        json!({"want": "overview", "state": state, "pixel": [24, 20], "number": first["at"]});
    let (told, _) = ask(&mut lab, request);
    let svg = told["drawing"].as_str().unwrap();
    for class in ["ray", "light-ray", "plane"] {
        assert!(svg.contains(&format!(r#"class="{class}""#)), "{class} in {svg}");
    }

    // With ray casting, what the ray opens of the structure (P13, P15).
    for acceleration in ["bvh", "grid", "oriented-box", "sphere"] {
        let settings = json!({"visibility": "ray-cast", "acceleration": acceleration});
        let state = small("builtin:cubs", settings);
        let request = json!({"want": "overview", "state": state, "pixel": [24, 20]});
        let (told, _) = ask(&mut lab, request);
        let svg = told["drawing"].as_str().unwrap();
        assert!(svg.contains(r#"class="part""#), "{acceleration}: {svg}");
    }
}

#[test]
fn normals_at_the_corners_and_all_lines_of_a_facet_are_told() {
    let mut lab = Lab::default();
    let state = small("builtin:sphere", json!({"shading": "gouraud"}));
    let (told, _) = ask(&mut lab, json!({"want": "explain", "state": state, "pixel": [24, 18]}));
    let normals = told["normals"].as_array().unwrap();
    assert_eq!(normals.len(), 3);
    assert!(normals.iter().all(|corner| corner["faces"].as_array().unwrap().len() >= 3));
    let lines = told["explanation"]["gouraud"]["lines"].as_array().unwrap();
    assert!(lines.iter().any(|line| line["row"] == 18), "{lines:?}");

    // The mirrored light is a unit vector (P38).
    let values = told["formula"]["values"].as_array().unwrap();
    if let Some(r) = values.iter().find(|row| row["symbol"].as_str().unwrap().starts_with("R (")) {
        let text = r["value"].as_str().unwrap();
        let length: f64 =
            text.split(' ').map(|c| c.parse::<f64>().unwrap()).map(|c| c * c).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() < 1e-5, "{text}");
    }
}

#[test]
fn l6_evaluations_are_those_of_faces_vertices_and_pixels() {
    let mut lab = Lab::default();
    let state = small("builtin:cubs", json!({"lighting": false}));
    let (told, _) = ask(&mut lab, json!({"want": "tally", "state": state}));
    // Eight cubes of one colour each, of which seven or eight are seen.
    let colors = told["colors"].as_u64().unwrap();
    assert!((7..=8).contains(&colors), "{told}");
    let of = |name: &str| told["evaluations"][name].as_u64().unwrap();
    assert!(of("flat") < of("gouraud") && of("gouraud") < of("phong"), "{told}");
    assert!(of("flat") >= 8 && of("flat") <= 48, "{told}");
}
