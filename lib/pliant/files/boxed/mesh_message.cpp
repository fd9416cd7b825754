#include "pliant/files/boxed/mesh_message.hpp"

namespace pliant {
namespace {

// Reads from the front. Data that is missing is read as zero or empty, and recorded as an error.
class MessageReader {
 public:
  explicit MessageReader(std::string_view bytes) : bytes_(bytes) {}

  bool is_sound() const { return is_sound_; }
  std::size_t left() const { return bytes_.size(); }
  bool is_at_end() const { return is_sound_ && bytes_.empty(); }

  std::string_view take(std::uint64_t size) {
    is_sound_ = is_sound_ && size <= bytes_.size();
    if (!is_sound_) return {};
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }

  template <class T>
  T number() {
    T number{};
    if (const auto bytes = take(sizeof number); is_sound_)
      std::memcpy(&number, bytes.data(), sizeof number);
    return number;
  }

  // At most 2^34 bytes: the size cannot overflow.
  template <class T>
  PackedNumbers<T> numbers(std::uint32_t count, std::uint32_t width = 1) {
    return PackedNumbers<T>(take(std::uint64_t{count} * width * sizeof(T)));
  }

  std::string_view text() { return take(number<std::uint32_t>()); }

  // A count of items with at least that many bytes each.
  std::uint32_t count(std::size_t least_bytes) {
    const auto count = number<std::uint32_t>();
    is_sound_ = is_sound_ && count <= most_objects && count <= left() / least_bytes;
    return is_sound_ ? count : 0;
  }

  bool fact() {
    const auto fact = number<std::uint32_t>();
    is_sound_ = is_sound_ && fact <= 1;
    return fact == 1;
  }

 private:
  std::string_view bytes_;
  bool is_sound_ = true;
};

// Whether the sum of the sizes equals the number of corners, so that a loop over them stays in
// range.
bool sizes_agree(const Submesh& submesh) {
  std::uint64_t corners = 0;
  for (std::size_t face = 0; face < submesh.sizes.size(); ++face) {
    if (submesh.sizes[face] < 3) return false;
    corners += submesh.sizes[face];
  }
  return corners == submesh.corners.size();
}

std::optional<Submesh> parse_submesh(MessageReader& reader) {
  Submesh submesh;
  submesh.material = reader.text();
  submesh.uv_sets = reader.number<std::uint32_t>();
  const bool is_lit = reader.fact(), has_uvs = reader.fact();
  const auto vertices = reader.number<std::uint32_t>();
  const auto faces = reader.number<std::uint32_t>();
  const auto corners = reader.number<std::uint32_t>();
  submesh.positions = reader.numbers<float>(vertices, 3);
  if (is_lit) submesh.normals = reader.numbers<float>(vertices, 3);
  if (has_uvs) submesh.uvs = reader.numbers<float>(vertices, 2);
  submesh.sizes = reader.numbers<std::uint32_t>(faces);
  submesh.corners = reader.numbers<std::uint32_t>(corners);
  if (!reader.is_sound() || !sizes_agree(submesh)) return {};
  return submesh;
}

bool parse_scene(MessageReader& reader, MeshMessage& message) {
  message.objects.resize(reader.count(2 * sizeof(std::uint32_t) + 3 * sizeof(std::uint64_t)));
  for (ObjectEntry& object : message.objects) {
    object.node = reader.text();
    object.mesh = reader.text();
    object.vertices = reader.number<std::uint64_t>();
    object.faces = reader.number<std::uint64_t>();
    object.left_out = reader.number<std::uint64_t>();
  }
  const auto chosen = reader.number<std::uint32_t>();
  if (!reader.is_sound() || chosen == no_object) return reader.is_sound();
  if (chosen >= message.objects.size()) return false;
  message.chosen = chosen;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      message.to_file(row, column) = reader.number<double>();
  const std::uint32_t submesh_count = reader.count(7 * sizeof(std::uint32_t));
  for (std::uint32_t k = 0; k < submesh_count; ++k) {
    const auto submesh = parse_submesh(reader);
    if (!submesh) return false;
    message.submeshes.push_back(*submesh);
  }
  return reader.is_sound() && !message.submeshes.empty();
}

}  // namespace

std::optional<MeshMessage> parse_mesh_message(std::string_view bytes) {
  MessageReader reader(bytes);
  MeshMessage message;
  if (reader.number<std::uint64_t>() != message_begin) return {};
  const auto kind = reader.number<std::uint32_t>();
  if (!reader.is_sound() || kind > static_cast<std::uint32_t>(MessageKind::TooManyObjects))
    return {};
  message.kind = static_cast<MessageKind>(kind);
  if (message.kind == MessageKind::Refused) message.reason = reader.text();
  if (message.kind == MessageKind::Scene && !parse_scene(reader, message)) return {};
  if (reader.number<std::uint64_t>() != message_end || !reader.is_at_end()) return {};
  return message;
}

}  // namespace pliant
