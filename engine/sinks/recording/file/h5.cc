#include "engine/sinks/recording/file/h5.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "engine/base/errors.h"
#include "engine/sinks/recording/file/plain_file.h"

namespace truestep {
namespace {

struct StackText {
  std::string innermost;
  int code = 0;  // errno, if the library reports it
};

// The library's description contains the file name, which only the owner may see.
std::string without_path(const std::string& text) {
  const size_t begin = text.find("name = '"), end = text.find('\'', begin + 8);
  if (begin == text.npos || end == text.npos) return text;
  return text.substr(0, begin) + text.substr(std::min(text.size(), text.find_first_not_of(", ", end + 1)));
}

herr_t visit(unsigned n, const H5E_error2_t* e, void* data) {
  auto& text = *static_cast<StackText*>(data);
  const std::string_view desc = e->desc ? e->desc : "";
  if (const size_t at = desc.find("errno = "); at != desc.npos) text.code = std::atoi(desc.data() + at + 8);
  if (n == 0) text.innermost = std::string(desc);
  return 0;
}

H5 text_type(std::string_view text) {
  H5 type = h5_id(H5Tcopy(H5T_C_S1), "make a text type");
  h5_ok(H5Tset_size(type, text.empty() ? 1 : text.size()), "size a text type");
  h5_ok(H5Tset_cset(type, H5T_CSET_UTF8), "set the character set");
  h5_ok(H5Tset_strpad(type, H5T_STR_NULLPAD), "set the padding");
  return type;
}

// The library reads at least one byte, so an empty text is one null.
const void* text_data(std::string_view text) {
  return text.empty() ? "" : text.data();
}

}  // namespace

// The library follows links: it is given the file that was opened without.
H5 h5_open_own(const std::string& path, unsigned mode, hid_t access) {
  const bool writes = (mode & H5F_ACC_RDWR) != 0;
  const int file = open_plainly(path, writes ? O_RDWR : O_RDONLY);
  if (file < 0) throw_recording_error("open the recording", errno);
  H5 opened(H5Fopen(("/proc/self/fd/" + std::to_string(file)).c_str(), mode, access));
  ::close(file);
  return opened;
}

void throw_h5_error(const char* what) {
  StackText text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, visit, &text);
  H5Eclear2(H5E_DEFAULT);
  const std::string failed = std::string("could not ") + what;
  switch (text.code) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      throw Error("disk_full", "the disk is full: " + failed);
    case EMFILE:
    case ENFILE:
      throw Error("overloaded", "no more files can be opened: " + failed);
    case 0:
      throw Error("recording_io", failed + ": " + without_path(text.innermost));
    default:
      throw Error("recording_io", failed + ": " + std::strerror(text.code));
  }
}

void h5_quiet() {
  // Every handle here is closed by its owner. The library's own cleanup at exit crashes on a file whose last
  // writes failed (a full disk), and must not change the process's exit code.
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

H5 h5_group(hid_t parent, const std::string& path) {
  H5 links = h5_id(H5Pcreate(H5P_LINK_CREATE), "make link properties");
  H5 group = h5_id(H5Pcreate(H5P_GROUP_CREATE), "make group properties");
  h5_ok(H5Pset_create_intermediate_group(links, 1), "set link properties");
  h5_ok(H5Pset_link_creation_order(group, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED),
        "track the order of links");
  // Room for links added after the frames, so that the group's header need not continue behind them.
  h5_ok(H5Pset_est_link_info(group, 8, 16), "reserve room for links");
  return h5_id(H5Gcreate2(parent, path.c_str(), links, group, H5P_DEFAULT), "create a group");
}

void h5_attribute(hid_t object, const char* name, std::string_view text) {
  H5 type = text_type(text);
  H5 space = h5_id(H5Screate(H5S_SCALAR), "make a scalar");
  H5 attribute =
      h5_id(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), "create an attribute");
  h5_ok(H5Awrite(attribute, type, text_data(text)), "write an attribute");
}

void h5_attribute(hid_t object, const char* name, const int64_t* values, size_t count) {
  const hsize_t dims[1] = {count};
  H5 space = h5_id(count == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, dims, nullptr), "make a shape");
  H5 attribute =
      h5_id(H5Acreate2(object, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT), "create an attribute");
  h5_ok(H5Awrite(attribute, H5T_NATIVE_INT64, values), "write an attribute");
}

void h5_attribute(hid_t object, const char* name, const double* values, size_t count) {
  const hsize_t dims[1] = {count};
  H5 space = h5_id(H5Screate_simple(1, dims, nullptr), "make a shape");
  H5 attribute =
      h5_id(H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), "create an attribute");
  h5_ok(H5Awrite(attribute, H5T_NATIVE_DOUBLE, values), "write an attribute");
}

void h5_dataset(hid_t parent, const char* name, hid_t type, const std::vector<hsize_t>& dims,
                const void* data) {
  H5 space = h5_id(dims.empty() ? H5Screate(H5S_SCALAR)
                                : H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr),
                   "make a shape");
  H5 set =
      h5_id(H5Dcreate2(parent, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "create a dataset");
  hsize_t elements = 1;
  for (hsize_t d : dims) elements *= d;
  if (elements > 0) h5_ok(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "write a dataset");
}

void h5_text(hid_t parent, const char* name, std::string_view text) {
  H5 type = text_type(text);
  h5_dataset(parent, name, type, {}, text_data(text));
}

}  // namespace truestep
