#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "pliant/core/stop_request.hpp"
#include "pliant/scene/format/contents.hpp"
#include "pliant/scene/format/format.hpp"
#include "pliant/scene/text/element_text.hpp"

namespace pliant::xml {

struct WrittenElement {
  ElementText element;
  std::int64_t copied_keys = 0;  ///< by the loops of its curves
};

/// The element that says what the contents lead to, without values and parts that are their
/// default; `formats` has the defaults. The names of files are relative to `folder`; empty: as they
/// are. Not all of it if the caller wants it to stop.
WrittenElement write_contents(Contents contents, const std::vector<ElementFormat>& formats,
                              const std::filesystem::path& folder = {},
                              const StopRequest& should_stop = {});

}  // namespace pliant::xml
