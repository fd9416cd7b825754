#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pliant/mesh/written/nurbs_net.hpp"
#include "pliant/scene/reading/element.hpp"
#include "pliant/scene/reading/scene_file.hpp"

namespace pliant::xml {

/// A direction of a net.
enum class Along { U, V };

/// The attribute of a <knots>.
struct KnotsText {
  std::optional<Along> along = {};
};

/// Reads the numbers in a <nurbs>.
class NetReader {
 public:
  NetReader(NurbsNet& net, const std::string& surface, SceneFile& file)
      : net_(net), surface_(surface), file_(file) {}

  void read_content(const Element& element);
  void record_content();  ///< the lines of its parts

 private:
  bool read_part(const Element& element, const std::string& part, std::vector<double>& numbers);
  void read_points(const Element& element);
  void read_knots(const Element& element);

  NurbsNet& net_;
  const std::string& surface_;
  SceneFile& file_;
  std::map<std::string, int> lines_;  // of its parts: points, weights, knotsU, knotsV
  std::vector<std::string> unsound_;
};

}  // namespace pliant::xml

namespace pliant {

inline constexpr std::string_view along_words[] = {"u", "v"};

template <>
struct Description<xml::KnotsText> {
  static constexpr std::string_view element = "knots";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "along",
                  .meaning = "direction of the knots",
                  .words = along_words,
                  .need = Need::Required},
        of.along...);
  }
};

}  // namespace pliant
