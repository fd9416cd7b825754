// Not linked into anything: the compiler must accept this file without macros, and reject it with
// any one of them. tests/core/CMakeLists.txt

#include "pliant/core/result.hpp"
#include "pliant/scene/text/text.hpp"
#include "pliant/timeline/edit/edit.hpp"
#include "pliant/timeline/path.hpp"

namespace {

[[maybe_unused]] pliant::Result<int> number() { return 1; }
[[maybe_unused]] pliant::Result<void> nothing() { return {}; }

[[maybe_unused]] void read_all(const pliant::Curve<3>& curve) {
  (void)number();
  (void)nothing();
  (void)pliant::xml::parse_number("1");
#ifdef DROPS_RESULT
  number();
#endif
#ifdef DROPS_RESULT_OF_NOTHING
  nothing();
#endif
#ifdef DROPS_READING
  pliant::xml::parse_number("1");
#endif
#ifdef DROPS_READING_OF_NOTHING
  pliant::xml::parse_numbers("1", {});
#endif
#ifdef DROPS_CURVE
  pliant::Curve<3>::make({});
#endif
#ifdef DROPS_EDIT
  pliant::reverse(curve, 0);
#endif
#ifdef DROPS_PATH
  pliant::Path::make({}, false);
#endif
  (void)curve;
}

}  // namespace
