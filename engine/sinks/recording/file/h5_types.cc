#include "engine/sinks/recording/file/h5_types.h"

namespace truestep {

hid_t h5_file_type(ElementType type) {
  switch (type) {
    case ElementType::kF32:
      return H5T_IEEE_F32LE;
    case ElementType::kF64:
      return H5T_IEEE_F64LE;
    case ElementType::kU32:
      return H5T_STD_U32LE;
    case ElementType::kI64:
      return H5T_STD_I64LE;
  }
  return H5T_IEEE_F64LE;
}

void h5_boundary_none(hid_t box) {
  const hsize_t three[1] = {3};
  H5 type = h5_id(H5Tcopy(H5T_C_S1), "make a text type");
  h5_ok(H5Tset_size(type, 4), "size a text type");
  h5_ok(H5Tset_strpad(type, H5T_STR_NULLPAD), "set the padding");
  H5 space = h5_id(H5Screate_simple(1, three, nullptr), "make a shape");
  H5 attribute =
      h5_id(H5Acreate2(box, "boundary", type, space, H5P_DEFAULT, H5P_DEFAULT), "create an attribute");
  h5_ok(H5Awrite(attribute, type, "nonenonenone"), "write an attribute");
}

}  // namespace truestep
