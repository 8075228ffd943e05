// The functions of Boost.Beast that are no templates: compiled here, once, instead of in every file that
// calls them (BOOST_BEAST_SEPARATE_COMPILATION).
#include <boost/beast/src.hpp>
