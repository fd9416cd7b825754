#pragma once

// Declarations of CLI11 types for the headers. CLI11 takes seconds to compile, so only files that
// add options include it.
namespace CLI {
class App;
class ParseError;
class Validator;
}  // namespace CLI
