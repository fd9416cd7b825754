#pragma once

// What the headers of the command name of CLI11, which takes seconds to compile: only files that
// add options include it.
namespace CLI {
class App;
class ParseError;
class Validator;
}  // namespace CLI
