// Geometry that a file holds compressed, as if it had not been: buffer views by EXT_meshopt_compression (in the
// spelling of gltfpack and of KHR), primitives by KHR_draco_mesh_compression.
#pragma once

#include "engine/scene/gltf_document.h"

namespace lambent::gltf {

/// The file's bytes as the parser takes them, which knows nothing of what is compressed: buffers that are only there
/// for who cannot decompress, and indices that Draco brings, are hidden from it. Returns nothing where the bytes may stay
/// as they are. Throws InputError.
std::vector<uint8_t> asParsed(const std::filesystem::path& file, const std::vector<uint8_t>& bytes);

/// Decodes all buffer views that are compressed. One that cannot be decoded is noted in doc.viewDefects, and does no
/// harm where nothing uses it. Throws InputError where the budget does not suffice.
void decodeViews(Document& doc);

/// Decodes what a primitive holds by Draco: its accessors that have no data of their own get them, and it gets indices
/// where it has none. Throws InputError for what is damaged or does not fit the accessors.
void decodePrimitive(Document& doc, tinygltf::Primitive& primitive, const std::string& place);

} // namespace lambent::gltf
