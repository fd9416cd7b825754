#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

// Tables of RFC 4180, and of spreadsheets. Internal to sweep.

/// A field as a table has it: in quotes if it has a comma, a quote or a line end.
std::string csv_field(std::string_view text);

inline constexpr std::size_t most_csv_fields = 10'000;  ///< of a row

/// A row of a table.
struct CsvRow {
  int line = 0;  ///< of its first character, counted from 1
  std::vector<std::string> fields = {};
};

/// The rows of a table, whose values are separated by commas, or, as its first row tells, by
/// semicolons or tabulators, as spreadsheets of some languages write; with line ends of either
/// kind, perhaps behind a byte order mark; rows without any character are left out. Errors:
/// InvalidInput with the line: a NUL byte; a quote that is not closed, or followed by something
/// else than a separator or the line's end; more than `most_csv_fields` fields in a row; with the
/// number, more than `most_rows` rows, which are not kept. Interrupted.
Result<std::vector<CsvRow>> parse_csv(std::string_view text, std::size_t most_rows,
                                      const StopRequest& should_stop = {});

}  // namespace pliant
