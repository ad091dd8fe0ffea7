//! Opening a glTF, binary or text, with the checks that its reader takes for granted.

use std::path::Path;

use base64::Engine as _;
use gltf::accessor::{DataType, Dimensions};
use gltf::animation::Property;
use gltf::binary::Glb;
use gltf::buffer;
use gltf::{Accessor, Document, Semantic, json};

use super::RigError;

/// A glTF with its data: every accessor that is read lies inside it and has a layout that glTF allows.
#[derive(Debug)]
pub(super) struct Source {
    pub(super) document: Document,
    buffers: Vec<Vec<u8>>,
}

impl Source {
    /// The bytes of a buffer.
    pub(super) fn bytes(&self, buffer: &gltf::Buffer<'_>) -> Option<&[u8]> {
        self.buffers.get(buffer.index()).map(Vec::as_slice)
    }
}

/// Parses a `.glb`, or a `.gltf` whose buffers are embedded or, where `folder` is given, lie in it.
pub(super) fn open(bytes: &[u8], folder: Option<&Path>) -> Result<Source, RigError> {
    let text = bytes.trim_ascii_start().starts_with(b"{");
    let (root, blob) = if text {
        (json::deserialize::from_slice(bytes)?, None)
    } else {
        open_binary(bytes)?
    };
    check_extensions(&root)?;
    check_indices(&root)?;
    let document = Document::from_json(root)?;
    let buffers = read_buffers(&document, blob, folder)?;
    let source = Source { document, buffers };
    source.check_accessors()?;
    Ok(source)
}

fn inconsistent<T>(what: String) -> Result<T, RigError> {
    Err(RigError::Inconsistent { what })
}

fn open_binary(bytes: &[u8]) -> Result<(json::Root, Option<Vec<u8>>), RigError> {
    let declared = bytes
        .get(8..12)
        .and_then(|b| b.try_into().ok())
        .map_or(0, u32::from_le_bytes);
    if !bytes.starts_with(b"glTF") || declared < 12 || declared as usize > bytes.len() {
        return inconsistent(
            "it is not a whole binary glTF: wrong first bytes, or cut short".into(),
        );
    }
    let glb = Glb::from_slice(bytes)?;
    let root = json::deserialize::from_slice(&glb.json)?;
    Ok((root, glb.bin.map(std::borrow::Cow::into_owned)))
}

/// Extensions that change how geometry is stored cannot be skipped.
fn check_extensions(root: &json::Root) -> Result<(), RigError> {
    const HARMLESS: [&str; 5] = [
        "KHR_materials_",
        "KHR_texture_",
        "EXT_texture_",
        "KHR_lights_",
        "VRM",
    ];
    let harmless = |name: &String| HARMLESS.iter().any(|start| name.starts_with(start));
    match root.extensions_required.iter().find(|name| !harmless(name)) {
        Some(name) => Err(RigError::Unsupported {
            what: format!("the extension {name}"),
        }),
        None => Ok(()),
    }
}

/// The crate's own validation takes for granted that primitives and animations name what exists.
fn check_indices(root: &json::Root) -> Result<(), RigError> {
    for (number, mesh) in root.meshes.iter().enumerate() {
        let name = named(mesh.name.as_deref(), number);
        let used = mesh
            .primitives
            .iter()
            .flat_map(|primitive| primitive.attributes.values().chain(&primitive.indices));
        if let Some(index) = used
            .map(|index| index.value())
            .find(|&i| i >= root.accessors.len())
        {
            return inconsistent(format!(
                "mesh {name} uses accessor {index}, which does not exist"
            ));
        }
    }
    for (number, animation) in root.animations.iter().enumerate() {
        let name = named(animation.name.as_deref(), number);
        for (number, channel) in animation.channels.iter().enumerate() {
            let node = channel.target.node.value();
            if node >= root.nodes.len() || channel.sampler.value() >= animation.samplers.len() {
                return inconsistent(format!(
                    "animation {name}, channel {number} moves node {node} by sampler {}, which do \
                     not both exist",
                    channel.sampler.value()
                ));
            }
            if matches!(channel.target.path, json::validation::Checked::Invalid) {
                return inconsistent(format!(
                    "animation {name}, channel {number} moves neither translation, rotation, scale \
                     nor weights"
                ));
            }
        }
    }
    Ok(())
}

/// How errors call a part of the file: by its name, else by its number.
pub(super) fn named(name: Option<&str>, number: usize) -> String {
    name.map_or_else(|| number.to_string(), |name| format!("`{name}`"))
}

fn read_buffers(
    document: &Document,
    mut blob: Option<Vec<u8>>,
    folder: Option<&Path>,
) -> Result<Vec<Vec<u8>>, RigError> {
    document
        .buffers()
        .map(|buffer| {
            let bytes = match buffer.source() {
                buffer::Source::Bin => blob.take().unwrap_or_default(),
                buffer::Source::Uri(uri) => read_uri(uri, folder)?,
            };
            if bytes.len() < buffer.length() {
                return inconsistent(format!(
                    "buffer {} has {} bytes, but {} are announced: it is cut short",
                    buffer.index(),
                    bytes.len(),
                    buffer.length()
                ));
            }
            Ok(bytes)
        })
        .collect()
}

/// A buffer that is embedded as base64, or a file beside the description.
fn read_uri(uri: &str, folder: Option<&Path>) -> Result<Vec<u8>, RigError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let coded = data.split_once(";base64,").map(|(_, coded)| coded);
        return coded
            .and_then(|coded| base64::engine::general_purpose::STANDARD.decode(coded).ok())
            .ok_or_else(|| RigError::Inconsistent {
                what: "an embedded buffer is not base64".into(),
            });
    }
    let Some(folder) = folder else {
        return Err(RigError::Unsupported {
            what: format!("the separate file {uri}"),
        });
    };
    let plain = Path::new(uri)
        .components()
        .all(|part| matches!(part, std::path::Component::Normal(_)));
    if !plain || uri.contains(':') {
        return Err(RigError::Unsupported {
            what: format!("a buffer outside its own folder ({uri})"),
        });
    }
    let path = folder.join(uri.replace("%20", " "));
    std::fs::read(&path).map_err(|source| RigError::Io { path, source })
}

impl Source {
    /// Whatever is read must lie inside the data and have a layout that the reader knows.
    fn check_accessors(&self) -> Result<(), RigError> {
        for mesh in self.document.meshes() {
            let name = named(mesh.name(), mesh.index());
            for primitive in mesh.primitives() {
                let place =
                    |what: &str| format!("{what} of mesh {name}, part {}", primitive.index());
                for (semantic, accessor) in primitive.attributes() {
                    let allowed = layouts(&semantic);
                    if !allowed.is_empty() {
                        self.check(&accessor, allowed, || place(&format!("{semantic:?}")))?;
                    }
                }
                if let Some(accessor) = primitive.indices() {
                    self.check(&accessor, INDEX_LAYOUTS, || place("indices"))?;
                }
            }
        }
        for skin in self.document.skins() {
            if let Some(accessor) = skin.inverse_bind_matrices() {
                let place =
                    || format!("bind matrices of skin {}", named(skin.name(), skin.index()));
                self.check(&accessor, &[(DataType::F32, Dimensions::Mat4)], place)?;
            }
        }
        for animation in self.document.animations() {
            let name = named(animation.name(), animation.index());
            for channel in animation.channels() {
                let allowed = output_layouts(channel.target().property());
                let place = || format!("animation {name}, channel {}", channel.index());
                if !allowed.is_empty() {
                    let scalar = &[(DataType::F32, Dimensions::Scalar)];
                    self.check(&channel.sampler().input(), scalar, place)?;
                    self.check(&channel.sampler().output(), allowed, place)?;
                }
            }
        }
        Ok(())
    }

    fn check(
        &self,
        accessor: &Accessor<'_>,
        allowed: &[Layout],
        place: impl Fn() -> String,
    ) -> Result<(), RigError> {
        let wrong = |why: String| {
            Err(RigError::Accessor {
                accessor: accessor.index(),
                place: place(),
                why,
            })
        };
        if accessor.sparse().is_some() {
            return wrong("it is sparse, which is not supported; export it in full".into());
        }
        let layout = (accessor.data_type(), accessor.dimensions());
        if !allowed.contains(&layout) {
            return wrong(format!("it cannot hold {:?} of {:?}", layout.1, layout.0));
        }
        if !self.holds(accessor) {
            return wrong("it reaches past the data: the file is cut short".into());
        }
        Ok(())
    }

    /// Whether every element of an accessor lies inside the data.
    fn holds(&self, accessor: &Accessor<'_>) -> bool {
        let Some(view) = accessor.view() else {
            return true;
        };
        let available = self.bytes(&view.buffer()).map_or(0, <[u8]>::len);
        let size = accessor.size();
        let stride = view.stride().unwrap_or(size);
        let last = accessor
            .count()
            .checked_sub(1)
            .and_then(|last| last.checked_mul(stride));
        let end = last.and_then(|start| start.checked_add(accessor.offset())?.checked_add(size));
        let view_end = view.offset().checked_add(view.length());
        end.is_some_and(|end| end <= view.length())
            && view_end.is_some_and(|end| end <= available)
            && stride >= size
    }
}

type Layout = (DataType, Dimensions);

const INDEX_LAYOUTS: &[Layout] = &[
    (DataType::U8, Dimensions::Scalar),
    (DataType::U16, Dimensions::Scalar),
    (DataType::U32, Dimensions::Scalar),
];

/// The layouts that glTF 2.0 allows for an attribute (section 3.7.2.1); none for one that is not read here.
fn layouts(semantic: &Semantic) -> &'static [Layout] {
    use DataType::{F32, U8, U16};
    use Dimensions::{Vec3, Vec4};
    match semantic {
        Semantic::Positions => &[(F32, Vec3)],
        Semantic::Colors(_) => &[
            (U8, Vec3),
            (U16, Vec3),
            (F32, Vec3),
            (U8, Vec4),
            (U16, Vec4),
            (F32, Vec4),
        ],
        Semantic::Joints(_) => &[(U8, Vec4), (U16, Vec4)],
        Semantic::Weights(_) => &[(U8, Vec4), (U16, Vec4), (F32, Vec4)],
        _ => &[],
    }
}

/// The layouts that glTF 2.0 allows for the values of an animation (section 3.11); none for what is not read.
fn output_layouts(property: Property) -> &'static [Layout] {
    use DataType::{F32, I8, I16, U8, U16};
    use Dimensions::{Vec3, Vec4};
    match property {
        Property::Translation | Property::Scale => &[(F32, Vec3)],
        Property::Rotation => &[
            (F32, Vec4),
            (I8, Vec4),
            (U8, Vec4),
            (I16, Vec4),
            (U16, Vec4),
        ],
        Property::MorphTargetWeights => &[],
    }
}
