# The lists that the unit tests draw.
target_sources(${bench_target} PRIVATE ${PROJECT_SOURCE_DIR}/tests/unit/pictures/picture_lists.cc)
