// The peer of the HTTP benchmark: a bare Beast server that answers every GET with the same 512 bytes. One
// thread, no time-outs, no routes, no checks: the cost of Beast alone. usage: beast_hello; prints "listening
// on URL".
#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <cstdio>
#include <string>

namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using Socket = asio::basic_stream_socket<asio::ip::tcp, asio::io_context::executor_type>;

asio::awaitable<void> serve(Socket socket, const std::string& body) {
  boost::beast::flat_buffer buffer;
  boost::system::error_code ec;
  for (;;) {
    http::request<http::empty_body> request;
    co_await http::async_read(socket, buffer, request, asio::redirect_error(asio::use_awaitable, ec));
    if (ec) co_return;
    http::response<http::span_body<const char>> response(http::status::ok, request.version());
    response.set(http::field::content_type, "application/json");
    response.keep_alive(request.keep_alive());
    response.body() = {body.data(), body.size()};
    response.prepare_payload();
    co_await http::async_write(socket, response, asio::redirect_error(asio::use_awaitable, ec));
    if (ec || !request.keep_alive()) co_return;
  }
}

asio::awaitable<void> listen(asio::ip::tcp::acceptor& acceptor, asio::io_context& io,
                             const std::string& body) {
  for (;;) {
    Socket socket = co_await acceptor.async_accept(io.get_executor(), asio::use_awaitable);
    socket.set_option(asio::ip::tcp::no_delay(true));
    asio::co_spawn(io, serve(std::move(socket), body), asio::detached);
  }
}

}  // namespace

int main() {
  asio::io_context io(1);
  const std::string body(512, 'f');
  asio::ip::tcp::acceptor acceptor(io, {asio::ip::make_address("127.0.0.1"), 0});
  std::printf("listening on http://127.0.0.1:%d\n", acceptor.local_endpoint().port());
  std::fflush(stdout);
  asio::co_spawn(io, listen(acceptor, io, body), asio::detached);
  io.run();
}
