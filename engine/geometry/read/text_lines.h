// Words of a text line by line, for readers of files; lines count from 1. A byte order mark is skipped;
// blanks are spaces, tabs and a carriage return at a line's end. A text whose first line ends with a carriage
// return alone, as on the Macintosh of old, has lines that end so.
#pragma once
#include <string>
#include <string_view>

#include "engine/geometry/read/mesh_fault.h"

namespace truestep {

class TextLines {
 public:
  explicit TextLines(std::string_view text);

  /// Goes to the next line; false at the end of the text, when the line number is one past the last.
  bool next();
  /// Goes to the next line with a word in it.
  bool next_filled();
  /// Takes the next word of the line; empty when there is none left.
  std::string_view word();
  /// The next word, without taking it.
  std::string_view peek() const;
  /// Goes from line to line for the next word: for formats in which lines have no meaning.
  std::string_view next_word();
  /// The rest of the line, trimmed.
  std::string_view rest() const;
  /// The complete line that next() went to, as long as no word has been taken; without its end.
  std::string_view whole() const { return rest_.ends_with('\r') ? rest_.substr(0, rest_.size() - 1) : rest_; }
  /// The rest of the text after this line.
  std::string_view text_after() const { return text_; }
  size_t line() const { return line_; }

  [[noreturn]] void fail(const std::string& message) const;
  /// The next word of the line as a coordinate: finite, at most kMostFileCoordinate. `what` for the message.
  double coordinate(const char* what);
  /// The next word as an integer within limits.
  int64_t integer(const char* what, int64_t least, int64_t most);

 private:
  std::string_view text_, rest_;
  size_t line_ = 0;
  char ending_ = '\n';
  bool ended_ = false;
};

/// A word for a message: quoted, cut to 40 characters, printable characters only.
std::string quoted(std::string_view word);
/// Parses a number, also with Fortran's D for the exponent; false when the text is not one.
bool read_double(std::string_view word, double& out);
/// ASCII comparison without case.
bool same_word(std::string_view a, std::string_view b);

}  // namespace truestep
