#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant {

/// The bytes of a text from `begin` up to, but not including, `end`.
struct TextRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;

  std::string_view of(std::string_view text) const { return text.substr(begin, end - begin); }

  friend bool operator==(const TextRange&, const TextRange&) = default;
};

/// A place in one of the texts of a scene.
struct TextPlace {
  static constexpr int nowhere = -1;

  int text = nowhere;  ///< index in the map of sources
  TextRange range = {};

  bool is_known() const { return text != nowhere; }

  friend bool operator==(const TextPlace&, const TextPlace&) = default;
};

/// A place in a file of a scene, for messages.
struct ScenePlace : TextSpan {
  std::string file = {};  ///< the scene's, as the caller named it, or one that is included
  /// How an included file became part of the scene, from the inside out: `included by rig.xml:4,
  /// by shot.xml:12`. Empty: it is the scene's own file.
  std::string chain = {};

  /// The message, with the chain at its end.
  std::string told(std::string message) const;
};

}  // namespace pliant
