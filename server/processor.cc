// Reports in a sentence that the processor lacks instructions the program is built for, instead of crashing
// with an illegal instruction. Compiled for every x86-64 and run before anything else in the program.
#if defined(__x86_64__)
#include <unistd.h>

namespace {

[[gnu::constructor(101)]] void require_processor() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"))
    return;
  static constexpr char kSentence[] =
      "truestep needs a processor with AVX2, FMA and BMI2 (Intel's since 2013, AMD's since 2015): this one "
      "lacks "
      "them, or the virtual machine hides them\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kSentence, sizeof kSentence - 1);
  _exit(1);
}

}  // namespace
#endif
