//! Opening a binary glTF, with the checks that its reader takes for granted.

use gltf::accessor::{DataType, Dimensions};
use gltf::binary::Glb;
use gltf::{Accessor, Document, Semantic, json};

use super::RigError;

/// Parses the file and makes sure that every accessor lies inside it, which the reader takes for granted.
pub(super) fn open(bytes: &[u8]) -> Result<(Document, Vec<u8>), RigError> {
    let declared = bytes
        .get(8..12)
        .and_then(|b| b.try_into().ok())
        .map_or(0, u32::from_le_bytes);
    if !bytes.starts_with(b"glTF") || declared < 12 || declared as usize > bytes.len() {
        return Err(RigError::Inconsistent {
            what: "it is not a whole binary glTF: wrong first bytes, or cut short".into(),
        });
    }
    let glb = Glb::from_slice(bytes)?;
    let root: json::Root = json::deserialize::from_slice(&glb.json)?;
    // The crate's own validation takes for granted that primitives name existing accessors.
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let named =
        primitives.flat_map(|primitive| primitive.attributes.values().chain(&primitive.indices));
    if let Some(accessor) = named
        .map(|index| index.value())
        .find(|&i| i >= root.accessors.len())
    {
        return Err(RigError::Inconsistent {
            what: format!("its mesh uses accessor {accessor}, which does not exist"),
        });
    }
    let document = Document::from_json(root)?;
    let blob = glb.bin.unwrap_or_default().into_owned();
    let embedded = |buffer: gltf::Buffer<'_>| matches!(buffer.source(), gltf::buffer::Source::Bin);
    if !document.buffers().all(embedded) || document.buffers().count() > 1 {
        return Err(RigError::Unsupported {
            what: "buffers outside the .glb".into(),
        });
    }
    for accessor in document.accessors() {
        check_bounds(&accessor, blob.len())?;
    }
    for primitive in document.meshes().flat_map(|mesh| mesh.primitives()) {
        let attributes = primitive.attributes();
        let indices = primitive
            .indices()
            .map(|accessor| (INDEX_LAYOUTS, accessor));
        let used = attributes.map(|(semantic, accessor)| (layouts(&semantic), accessor));
        for (allowed, accessor) in used.chain(indices) {
            check_layout(&accessor, allowed)?;
        }
    }
    for accessor in document
        .skins()
        .filter_map(|skin| skin.inverse_bind_matrices())
    {
        check_layout(&accessor, &[(DataType::F32, Dimensions::Mat4)])?;
    }
    Ok((document, blob))
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

fn check_layout(accessor: &Accessor<'_>, allowed: &[Layout]) -> Result<(), RigError> {
    let layout = (accessor.data_type(), accessor.dimensions());
    if allowed.is_empty() || allowed.contains(&layout) {
        return Ok(());
    }
    Err(RigError::Inconsistent {
        what: format!("accessor {} cannot hold {layout:?}", accessor.index()),
    })
}

/// Every element of an accessor must lie inside the data.
fn check_bounds(accessor: &Accessor<'_>, blob_length: usize) -> Result<(), RigError> {
    let Some(view) = accessor.view() else {
        return Ok(());
    };
    let size = accessor.size();
    let stride = view.stride().unwrap_or(size);
    let last = accessor
        .count()
        .checked_sub(1)
        .and_then(|last| last.checked_mul(stride));
    let end = last.and_then(|start| start.checked_add(accessor.offset())?.checked_add(size));
    let view_end = view.offset().checked_add(view.length());
    let inside = end.is_some_and(|end| end <= view.length())
        && view_end.is_some_and(|end| end <= blob_length)
        && stride >= size;
    if inside && accessor.sparse().is_none() {
        return Ok(());
    }
    Err(RigError::Inconsistent {
        what: format!(
            "accessor {} is sparse or reaches past the data",
            accessor.index()
        ),
    })
}
