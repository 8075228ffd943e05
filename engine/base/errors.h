// Errors that users see. Each has a machine-readable code, the JSON pointer of the offending value (empty
// when no input is involved), and what would have been allowed.
#pragma once
#include <stdexcept>
#include <string>
#include <vector>

namespace truestep {

/// One thing wrong with an input, or worth a warning. `pointer` is an RFC 6901 JSON pointer.
struct Issue {
  std::string pointer;
  std::string code;          ///< snake_case, stable: out_of_range, unknown_key, wrong_type ...
  std::string message;       ///< one sentence for a person
  std::string value;         ///< the offending value as JSON text, possibly shortened
  std::string allowed;       ///< what would have been accepted
  std::string did_you_mean;  ///< nearest allowed name, empty when nothing is near
  std::string unit;          ///< SI unit of the value, empty when it has none
};

}  // namespace truestep

// Compiled once, in errors.cc: almost every file reports something.
extern template class std::vector<truestep::Issue>;
extern template class std::vector<std::string>;

namespace truestep {

/// A failure with a stable code (see the table of codes in the HTTP description).
class Error : public std::runtime_error {
 public:
  Error(std::string code, const std::string& detail);
  Error(std::string code, const std::string& detail, std::vector<Issue> issues);
  Error(std::string code, const std::string& detail, Issue issue);
  Error(const Error&);
  Error& operator=(const Error&);
  ~Error() override;
  const std::string& code() const { return code_; }
  const std::vector<Issue>& issues() const { return issues_; }

 private:
  std::string code_;
  std::vector<Issue> issues_;
};

/// A state that became non-finite or left its bounds; thrown by a step, caught by the session.
class Instability : public Error {
 public:
  Instability(std::string system, std::string quantity, long long index, const std::string& detail);
  Instability(const Instability&);
  Instability& operator=(const Instability&);
  ~Instability() override;
  std::string system;       ///< id of the system that failed
  std::string quantity;     ///< column that is non-finite
  long long index;          ///< row of the first bad value; -1: `quantity` is not a column of rows
  long long step = -1;      ///< step that failed (filled in by the world)
  double suggested_dt = 0;  ///< step that the method would have survived, 0 if unknown
};

}  // namespace truestep
