// Thin ownership of HDF5 identifiers and one way of turning the library's error stack into an Error.
// Private to engine/sinks/recording; every call runs on the RecordingThread (the serial library is not
// thread-safe) or in a child process of its own.
#pragma once
#include <hdf5.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace truestep {

/// Owns one HDF5 identifier of any kind.
class H5 {
 public:
  H5() = default;
  H5(hid_t id) : id_(id) {}
  H5(H5&& o) noexcept : id_(std::exchange(o.id_, -1)) {}
  H5& operator=(H5&& o) noexcept {
    if (this != &o) {
      reset();
      id_ = std::exchange(o.id_, -1);
    }
    return *this;
  }
  ~H5() { reset(); }
  void reset() {
    if (id_ >= 0) H5Idec_ref(id_);
    id_ = -1;
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = -1;
};

/// Throws the library's error stack as an Error: disk_full if the system said so, otherwise recording_io.
/// `what` is a verb phrase.
[[noreturn]] void throw_h5_error(const char* what);

/// Opens a recording's own file, which is no link (Error as of files that are written plainly); negative
/// when the library cannot.
H5 h5_open_own(const std::string& path, unsigned mode, hid_t access);

/// `id`, or throws when it is negative.
inline H5 h5_id(hid_t id, const char* what) {
  if (id < 0) throw_h5_error(what);
  return H5(id);
}

/// Throws when `status` is negative.
inline void h5_ok(long long status, const char* what) {
  if (status < 0) throw_h5_error(what);
}

/// Stops the library from printing its error stack.
void h5_quiet();

/// A group that tracks and indexes the order in which its links were made; missing parents are made too.
H5 h5_group(hid_t parent, const std::string& path);

/// Attributes: text (fixed length, UTF-8), and arrays of numbers; `count` 0 makes a scalar.
void h5_attribute(hid_t object, const char* name, std::string_view text);
void h5_attribute(hid_t object, const char* name, const int64_t* values, size_t count);
void h5_attribute(hid_t object, const char* name, const double* values, size_t count);

/// A contiguous dataset written at once.
void h5_dataset(hid_t parent, const char* name, hid_t type, const std::vector<hsize_t>& dims,
                const void* data);
/// A scalar text dataset (fixed length, UTF-8).
void h5_text(hid_t parent, const char* name, std::string_view text);

}  // namespace truestep
