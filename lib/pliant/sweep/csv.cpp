#include "pliant/sweep/csv.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/stop_request.hpp"
#include "pliant/sweep/takes.hpp"

namespace pliant {

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string field = "\"";
  for (const char c : text) {
    if (c == '"') field += '"';
    field += c;
  }
  return field + '"';
}

namespace {

// A comma, unless the first row with any character has a semicolon or a tabulator, and no comma.
char separator_of(std::string_view text, StopPoll& stop) {
  bool is_quoted = false, is_empty = true;
  char found = 0;
  for (const char c : text) {
    if (stop.after()) break;
    if (c == '"') is_quoted = !is_quoted;
    if (is_quoted) continue;
    if (c == '\n' && !is_empty) break;
    if (c == ',') return ',';
    if ((c == ';' || c == '\t') && found == 0) found = c;
    is_empty = is_empty && (c == '\n' || c == '\r');
  }
  return found == 0 ? ',' : found;
}

}  // namespace

Result<std::vector<CsvRow>> parse_csv(std::string_view text, std::size_t most_rows,
                                      const StopRequest& should_stop) {
  if (const std::size_t nul = text.find('\0'); nul != std::string_view::npos) {
    const std::string_view before = text.substr(0, nul);
    return invalid("has a NUL byte, which no table has",
                   static_cast<int>(1 + std::count(before.begin(), before.end(), '\n')));
  }
  StopPoll stop(should_stop);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  char separator = separator_of(text, stop);
  int line = 1;
  if (constexpr std::string_view told = "sep="; text.starts_with(told) && text.size() > 5) {
    separator = text[told.size()];  // a spreadsheet says it in a line of its own
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
    ++line;
  }
  std::vector<CsvRow> rows;
  std::size_t count = 0, field_count = 0;
  CsvRow row{.line = line};
  std::string field;
  bool is_empty = true;  // the row
  const auto end_row = [&] {
    row.fields.push_back(std::exchange(field, {}));
    if (!is_empty && ++count <= most_rows) rows.push_back(std::move(row));
    row = CsvRow{.line = line};
    is_empty = true;
  };
  for (std::size_t at = 0; at < text.size();) {
    if (stop.after()) return interrupted();
    const char c = text[at];
    if (c == '"' && field.empty()) {
      const int begin = line;
      is_empty = false;
      for (++at;; ++at) {
        if (stop.after()) return interrupted();
        if (at == text.size()) return invalid("a quote is not closed", begin);
        if (text[at] == '\n') ++line;
        if (text[at] != '"') {
          field += text[at];
        } else if (at + 1 < text.size() && text[at + 1] == '"') {
          field += text[++at];
        } else {
          ++at;
          break;
        }
      }
      if (at < text.size() && text[at] != separator && text[at] != '\n' && text[at] != '\r')
        return invalid(
            fmt::format("a {} is missing behind a closing quote", separator == ','   ? "comma"
                                                                  : separator == ';' ? "semicolon"
                                                                                     : "tabulator"),
            line);
      continue;
    }
    ++at;
    if (c == separator) {
      is_empty = false;
      row.fields.push_back(std::exchange(field, {}));
      if (row.fields.size() >= most_csv_fields)
        return invalid(fmt::format("has more than {} values", most_csv_fields), row.line);
      if (++field_count > most_take_texts)
        return invalid(fmt::format("the table has more than {} values", most_take_texts), row.line);
    } else if (c == '\n') {
      ++line;
      end_row();
    } else if (c != '\r' || (at < text.size() && text[at] != '\n')) {
      is_empty = false;
      field += c;
    }
  }
  end_row();
  if (count > most_rows)
    return invalid(fmt::format("{} rows are too many; at most {} are allowed", count, most_rows),
                   1);
  return rows;
}

}  // namespace pliant
