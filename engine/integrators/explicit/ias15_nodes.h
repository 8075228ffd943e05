// Gauss-Radau points of order 15 on [0, 1], including the left end: the zeros of P_7(2s - 1) + P_8(2s - 1)
// (Everhart 1985, table 1).
#pragma once
#include <array>

namespace truestep {

inline constexpr std::array<double, 8> kIas15Nodes = {0,
                                                      0.0562625605369221464656521910318,
                                                      0.180240691736892364987579942780,
                                                      0.352624717113169637373907769648,
                                                      0.547153626330555383001448554766,
                                                      0.734210177215410531523210605558,
                                                      0.885320946839095768090359771030,
                                                      0.977520613561287501891174488626};

}  // namespace truestep
