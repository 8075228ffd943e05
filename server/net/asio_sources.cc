// The functions of Boost.Asio that are no templates: compiled here, once, instead of in every file that calls
// them (BOOST_ASIO_SEPARATE_COMPILATION).
#include <boost/asio/impl/src.hpp>
