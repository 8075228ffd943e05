// Logging goes through spdlog's default logger (stderr); the server sets level and pattern.
#pragma once
#include <spdlog/spdlog.h>
