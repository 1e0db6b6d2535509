//! What desktops are told: which types of files there are, who makes thumbnails of them, who opens
//! them.

use std::fmt::Write;

/// A format of models: its type, the patterns of its names, what it is called, and how its files
/// begin.
struct Kind {
    media_type: &'static str,
    patterns: &'static [&'static str],
    comment: &'static str,
    begins: Option<&'static str>,
}

/// The formats that `vitral formats` tells, without scene files, whose names are those of any JSON.
/// Types are IANA's, or those that other viewers install.
const KINDS: [Kind; 6] = [
    Kind {
        media_type: "model/gltf+json",
        patterns: &["*.gltf"],
        comment: "glTF model",
        begins: None,
    },
    Kind {
        media_type: "model/gltf-binary",
        patterns: &["*.glb"],
        comment: "glTF binary model",
        begins: Some("glTF"),
    },
    Kind {
        media_type: "model/obj",
        patterns: &["*.obj"],
        comment: "Wavefront OBJ model",
        begins: None,
    },
    Kind {
        media_type: "model/stl",
        patterns: &["*.stl"],
        comment: "Stereolithography model",
        begins: None,
    },
    Kind {
        media_type: "application/vnd.ply",
        patterns: &["*.ply"],
        comment: "PLY model",
        begins: Some("ply"),
    },
    Kind {
        media_type: "application/vnd.off",
        patterns: &["*.off"],
        comment: "OFF model",
        begins: Some("OFF"),
    },
];

/// All types, as desktop files list them.
fn types() -> String {
    KINDS.iter().map(|kind| format!("{};", kind.media_type)).collect()
}

/// The entry that has file managers make thumbnails: `share/thumbnailers/vitral.thumbnailer`.
pub(super) fn thumbnailer() -> String {
    format!(
        "[Thumbnailer Entry]\nTryExec=vitral\nExec=vitral thumbnail %i %o %s\nMimeType={}\n",
        types()
    )
}

/// The entry that opens models in the Lab: `share/applications/vitral.desktop`. The Lab serves its
/// page until its terminal is closed.
pub(super) fn entry() -> String {
    format!(
        "[Desktop Entry]\nVersion=1.0\nType=Application\nName=Vitral\nGenericName=Laboratory of 3D rendering\n\
         Comment=Watch the classical algorithms of 3D graphics at work on a model\n\
         TryExec=vitral\nExec=vitral lab %F\nIcon=vitral\nTerminal=true\nCategories=Graphics;3DGraphics;\n\
         Keywords=3D;model;render;stl;obj;ply;off;gltf;glb;\nMimeType={}\n",
        types()
    )
}

/// The types themselves: `share/mime/packages/vitral.xml`.
pub(super) fn media_types() -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <mime-info xmlns=\"http://www.freedesktop.org/standards/shared-mime-info\">\n",
    );
    for Kind { media_type, patterns, comment, begins } in KINDS {
        // Writing to a String cannot fail.
        let _ =
            writeln!(text, "  <mime-type type=\"{media_type}\">\n    <comment>{comment}</comment>");
        if let Some(begins) = begins {
            let _ = writeln!(text, "    <magic priority=\"50\">");
            let _ = writeln!(
                text,
                "      <match type=\"string\" offset=\"0\" value=\"{begins}\"/>\n    </magic>"
            );
        }
        for pattern in patterns {
            let _ = writeln!(text, "    <glob pattern=\"{pattern}\"/>");
        }
        let _ = writeln!(text, "  </mime-type>");
    }
    text.push_str("</mime-info>\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_type_is_told_everywhere() {
        for kind in KINDS {
            assert!(media_types().contains(&format!("<mime-type type=\"{}\">", kind.media_type)));
            assert!(thumbnailer().contains(kind.media_type) && entry().contains(kind.media_type));
        }
        let xml = media_types();
        assert_eq!(xml.matches("<mime-type ").count(), xml.matches("</mime-type>").count());
        assert!(entry().lines().skip(1).all(|line| line.contains('=')));
    }
}
