"""Which requests `pliant view --serve` answers: an attacker's bytes, and the answers.

An attacker here is any program of the machine and, through a browser, any web page: it knows the
port, but not the token. The limits are also valid for clients that know the token.
"""

import base64
import hashlib
import os
import random
import re
import resource
import select
import signal
import socket
import tempfile
import threading
import time
import unittest

from command import Command, SANITIZED, SCENE, main
from view_server import HAS_PAGE, Server, exchange, statuses

CONNECTIONS, STRANGERS, STREAMS, REQUESTS = 64, 16, 16, 100  # HttpLimits
HEAD_SECONDS, WRITE_SECONDS = 2, 10
SLACK = 6 if SANITIZED else 3  # seconds; the machine may be busy

EVENTS = '<noise name="n" frequency="0.5" rate="4" deformationRadius="300" forceRadius="300" magnitude="4000"/></scene>'


@unittest.skipUnless(HAS_PAGE, "this build has no page")
class Serving(Command):
    """One command for all tests of a class; it must still run after each of them."""

    @classmethod
    def setUpClass(cls):
        cls.home = tempfile.TemporaryDirectory(prefix="pliant-serve-")
        scene = os.path.join(cls.home.name, "scene.xml")
        with open(scene, "w", encoding="utf-8") as file:
            file.write(SCENE.format(end=4))
        cls.server = Server(scene)
        cls.server.wait_for("baked")
        cls.server.stop_listening()

    @classmethod
    def tearDownClass(cls):
        code, _, errors = cls.server.close()
        cls.home.cleanup()
        assert (code, errors) == (0, ""), (code, errors)

    def tearDown(self):
        self.assertEqual(statuses(self.ask())[:1], [200], "it answers nobody any more")

    def ask(self, *lines, **options):
        """The whole answer to a single request."""
        return self.server.send(self.server.request("bake", *lines, **options), end=True)

    def refused(self, status, *pieces, **options):
        """Checks that the pieces are answered once, with only that status, and that the connection
        is closed."""
        answer = self.server.send(*pieces, **options)
        self.assertEqual(statuses(answer), [status], answer[:300])
        head, body = answer.split(b"\r\n\r\n", 1)
        self.assertEqual(body, b"")
        self.assertIn(b"Connection: close", head)
        return head


class Ending(Serving):
    def test_who_wants_one_answer_gets_one(self):
        for wish in ("close", "Close"):
            answer = self.server.send(self.server.request("bake", f"Connection: {wish}") + self.server.request())
            self.assertEqual(statuses(answer), [200])
            self.assertIn(b"Connection: close", answer.split(b"\r\n\r\n", 1)[0])


class Smuggling(Serving):
    def test_the_body_of_what_is_refused_is_no_request(self):
        inner = self.server.request()
        bodies = (inner, b"\r\n" + inner, b"\n" + inner, b"x" * 40000 + inner)
        for body in bodies:
            length = f"Content-Length: {len(body)}"
            for status, outer in (
                    (403, self.server.request("picture", length, method="POST", host="evil.example")),
                    (403, self.server.request("picture", length, "Origin: http://evil.example", method="POST")),
                    (403, self.server.request("picture", length, method="POST", target="/picture")),
                    (404, self.server.request("nothing", length, method="POST")),
                    (405, self.server.request("bake", length, method="POST")),
                    (413, self.server.request("bake", length)),
                    (501, self.server.request("bake", "Transfer-Encoding: chunked"))):
                with self.subTest(status=status, body=body[:10], length=len(body)):
                    self.refused(status, outer + body)
                    self.refused(status, outer, body)
                    # The end of the body is sent late.
                    self.refused(status, outer, body[:-9], body[-9:])

    def test_what_stands_behind_a_refused_request_is_not_looked_at(self):
        self.refused(403, self.server.request(host="evil.example") + self.server.request())
        answer = self.server.send(self.server.request() + self.server.request(host="evil.example") + self.server.request())
        self.assertEqual(statuses(answer), [200, 403])

    def test_requests_in_one_piece_are_answered_in_their_order(self):
        one, page = self.server.request("bake"), self.server.request("")
        answer = self.server.send(one + page + one + page, end=True)
        self.assertEqual(statuses(answer), [200] * 4)
        kinds = re.findall(rb"\nContent-Type: ([a-z/-]+)", answer)
        self.assertEqual(kinds, [b"application/octet-stream", b"text/html"] * 2)

    def test_a_connection_has_so_many_requests(self):
        answer = self.server.send(self.server.request() * (2 * REQUESTS))
        self.assertEqual(statuses(answer), [200] * REQUESTS)

    def test_lengths_that_lie_or_are_none(self):
        for value, status in (("-1", 400), ("+5", 400), ("0x5", 400), ("5, 5", 400), ("5 5", 400), ("", 400), ("five", 400),
                              ("1e3", 400), ("18446744073709551616", 400), ("99999999999999999999999999", 400),
                              ("18446744073709551615", 413), ("1", 413), ("5", 413)):
            with self.subTest(value):
                self.refused(status, self.server.request("bake", f"Content-Length: {value}") + b"hello")
        self.assertEqual(statuses(self.ask("Content-Length: 0")), [200])

    def test_two_ways_to_find_the_end_of_a_body(self):
        for lines in (("Content-Length: 5", "Content-Length: 6"), ("Content-Length: 5", "Content-Length: 5"),
                      ("Content-Length: 0", "Content-Length: 0"), ("Content-Length: 0", "content-length: 0")):
            with self.subTest(lines):
                self.refused(400, self.server.request("bake", *lines) + b"hello")
        inner = self.server.request()
        for lines in (("Transfer-Encoding: chunked", "Content-Length: 5"), ("Content-Length: 5", "Transfer-Encoding: chunked"),
                      ("Transfer-Encoding: chunked",), ("Transfer-Encoding: identity",), ("Transfer-Encoding: gzip, chunked",),
                      ("transfer-encoding: xchunked",), ("Transfer-Encoding:",), ("Transfer-Encoding: chunked",) * 2,
                      ("Transfer-Encoding : chunked",), ("Transfer-Encoding\t: chunked",)):
            for body in (b"0\r\n\r\n", b"5\r\nhello\r\n0\r\n\r\n", b"ffffffffffffffffff\r\n", b"-1\r\n", b"5;" + b"x" * 9999 + b"\r\nhello\r\n",
                         b"zz\r\n\r\n", b"0\n\n"):
                with self.subTest(lines, body=body[:12]):
                    answer = self.server.send(self.server.request("bake", *lines) + body + inner)
                    self.assertIn(statuses(answer), ([400], [501]))

    def test_a_field_that_stands_twice_is_refused(self):
        own = f"127.0.0.1:{self.server.port}"
        for lines in ((f"Host: {own}",), ("Host: evil.example",), ("Origin: null", f"Origin: http://{own}"),
                      ("Sec-Fetch-Site: same-origin", "Sec-Fetch-Site: cross-site"), ("X: 1", "x: 1")):
            with self.subTest(lines):
                self.refused(400, self.server.request("bake", *lines))


class Names(Serving):
    def test_without_the_token_there_is_nothing(self):
        token = self.server.token
        other = ("0" if token[0] != "0" else "1") + token[1:]
        for target in ("/", "/bake", "/events", "/take", "/job", f"/{other}/", f"/{other}/bake", f"/{token[:-1]}/bake", f"/{token}0/bake",
                       f"//{token}/bake", f"/./{token}/bake", f"/{token.upper()}x/bake", "/" + "0" * 32 + "/bake", "/" + "0" * 8000 + "/bake",
                       f"/?{token}", f"/bake?token={token}", f"/%{ord(token[0]):x}{token[1:]}/bake", f"/{token[:16]}\\{token[16:]}/bake",
                       f"http://127.0.0.1:{self.server.port}/{token}/bake", "*", f"{token}/bake"):
            with self.subTest(target[:80]):
                head = self.refused(403, self.server.request(target=target))
                self.assertNotIn(b"sha256", head)
        for method in ("HEAD", "POST", "OPTIONS", "DELETE"):
            self.refused(403, self.server.request(target="/", method=method))

    def test_with_the_token_there_is_what_there_is(self):
        for place, status in (("", 200), ("bake", 200), ("take", 404), ("job", 404), ("bake/", 404), ("bake?x", 404),
                              ("../bake", 404), ("%62ake", 404), ("/bake", 404), ("BAKE", 404), ("scene.xml", 404)):
            with self.subTest(place):
                answer = self.server.send(self.server.request(place), end=True)
                self.assertEqual(statuses(answer), [status])
        self.refused(404, self.server.request(target=f"/{self.server.token}"))

    def test_other_methods_are_refused(self):
        for method in ("HEAD", "PUT", "DELETE", "OPTIONS", "TRACE", "PATCH", "get", "GETT", "POST"):
            with self.subTest(method):
                self.refused(405, self.server.request(method=method))
        self.refused(403, self.server.request(method="CONNECT", target=f"127.0.0.1:{self.server.port}"))
        # This command has not been asked for a picture.
        self.refused(404, self.server.request("picture", "Content-Length: 3", method="POST") + b"png")

    def test_only_by_this_machines_own_names(self):
        port = self.server.port
        for host in (f"127.0.0.1:{port}", f"localhost:{port}"):
            self.assertEqual(statuses(self.ask(host=host)), [200])
            self.assertEqual(statuses(self.ask(f"Origin: http://{host}", host=host)), [200])
        for host in ("evil.example", f"evil.example:{port}", "localhost", "127.0.0.1", f"127.0.0.1:{port + 1}", f"127.0.0.1:{port}0", "",
                     f"127.0.0.1.evil.example:{port}", f"user@127.0.0.1:{port}", f"127.0.0.1:{port}, evil.example", f"127.1:{port}",
                     f"[::1]:{port}", f"0.0.0.0:{port}", f"LOCALHOST.:{port}"):
            with self.subTest(host):
                for place in ("", "bake", "events"):
                    self.refused(403, self.server.request(place, host=host))
        self.refused(403, f"GET {self.server.path('bake')} HTTP/1.1\r\n\r\n".encode())

    def test_only_for_the_servers_own_pages(self):
        port = self.server.port
        for origin in ("http://evil.example", "null", "", "file://", f"http://evil.example:{port}", f"https://127.0.0.1:{port}",
                       f"http://localhost:{port}", f"http://127.0.0.1:{port}/", f"http://127.0.0.1:{port + 1}", "*"):
            with self.subTest(origin):
                for place in ("", "bake", "events"):
                    self.refused(403, self.server.request(place, f"Origin: {origin}"))
        for site, page, rest in (("same-origin", 200, 200), ("none", 200, 403), ("same-site", 403, 403), ("cross-site", 403, 403),
                                 ("", 403, 403), ("Same-Origin", 403, 403), ("same-origin, none", 403, 403)):
            with self.subTest(site):
                self.assertEqual(statuses(self.server.send(self.server.request("", f"Sec-Fetch-Site: {site}"), end=True)), [page])
                self.assertEqual(statuses(self.ask(f"Sec-Fetch-Site: {site}")), [rest])
        # The fields that a browser sends for a link or a frame in a foreign page, and for its
        # scripts.
        for more in (("Sec-Fetch-Mode: navigate", "Sec-Fetch-Dest: document"), ("Sec-Fetch-Mode: navigate", "Sec-Fetch-Dest: iframe"),
                     ("Sec-Fetch-Mode: no-cors", "Sec-Fetch-Dest: script")):
            self.refused(403, self.server.request("", "Sec-Fetch-Site: cross-site", *more))

    def test_what_the_answers_let_a_browser_do(self):
        head, page = self.server.send(self.server.request(""), end=True).split(b"\r\n\r\n", 1)
        fields = dict(line.split(": ", 1) for line in head.decode().split("\r\n")[1:])
        script = re.search(rb'<script type="module">(.*?)</script>', page, re.DOTALL).group(1)
        sha = base64.b64encode(hashlib.sha256(script).digest()).decode()
        rules = dict(rule.split(" ", 1) for rule in fields["Content-Security-Policy"].split("; "))
        self.assertEqual(rules.pop("script-src"), f"'sha256-{sha}'")
        self.assertRegex(rules.pop("style-src"), r"^'sha256-\S+'$")
        self.assertEqual(rules, {"default-src": "'none'", "img-src": "data: blob:", "connect-src": "'self'", "base-uri": "'none'",
                                 "form-action": "'none'", "frame-ancestors": "'none'"})
        bake = self.ask().split(b"\r\n\r\n", 1)[0].decode()
        refusal = self.refused(403, self.server.request(target="/")).decode()
        self.assertIn("Content-Security-Policy: default-src 'none'; frame-ancestors 'none'\r\n", bake)
        for answer in (head.decode(), bake, refusal):
            for line in ("Cache-Control: no-store", "X-Content-Type-Options: nosniff", "Cross-Origin-Resource-Policy: same-origin",
                         "Cross-Origin-Opener-Policy: same-origin", "Referrer-Policy: no-referrer", "X-Frame-Options: DENY"):
                self.assertIn("\r\n" + line, answer)
            self.assertNotIn("Access-Control", answer)

    def test_two_commands_have_two_tokens(self):
        other = Server(self.scene(4))
        try:
            self.assertNotEqual(other.token, self.server.token)
            self.assertEqual(statuses(exchange(other.port, other.request(target=self.server.path("bake")))), [403])
        finally:
            other.close()


class Forms(Serving):
    def test_what_is_no_request_of_http_1_1(self):
        path, host = self.server.path("bake"), f"Host: 127.0.0.1:{self.server.port}"
        for text in (f"GET {path}\r\n", f"GET {path} HTTP/0.9\r\n{host}\r\n\r\n", f"GET {path} HTTP/1.0\r\n{host}\r\n\r\n",
                     f"GET {path} HTTP/1.2\r\n{host}\r\n\r\n", f"GET {path} http/1.1\r\n{host}\r\n\r\n", f"GET {path} HTTP/11\r\n{host}\r\n\r\n",
                     "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", f"GET {path} HTTP/1.1\n{host}\n\n", f"GET {path} HTTP/1.1\r{host}\r\r",
                     f"GET {path} HTTP/1.1\r\n{host}\n\r\n\r\n", f"GET {path} HTTP/1.1\r\n{host}\r\n\n", "\r\n" + f"GET {path} HTTP/1.1\r\n{host}\r\n\r\n",
                     f" GET {path} HTTP/1.1\r\n{host}\r\n\r\n", f"GET  {path} HTTP/1.1\r\n{host}\r\n\r\n", f"GET {path}  HTTP/1.1\r\n{host}\r\n\r\n",
                     f"GET\t{path}\tHTTP/1.1\r\n{host}\r\n\r\n", f"GET {path} x HTTP/1.1\r\n{host}\r\n\r\n", f"GET HTTP/1.1\r\n{host}\r\n\r\n",
                     f" HTTP/1.1\r\n{host}\r\n\r\n", f"G\0T {path} HTTP/1.1\r\n{host}\r\n\r\n", f"GET {path}\0 HTTP/1.1\r\n{host}\r\n\r\n",
                     f"GET {path} HTTP/1.1\r\n{host}\0\r\n\r\n", f"GET {path} HTTP/1.1\r\n{host}\r\nX: a\0b\r\n\r\n",
                     f"GET {path} HTTP/1.1\r\n{host}\r\nX: a\r\n b\r\n\r\n", f"GET {path} HTTP/1.1\r\n{host}\r\nX: a\r\n\tb\r\n\r\n",
                     f"GET {path} HTTP/1.1\r\n X: a\r\n{host}\r\n\r\n", f"GET {path} HTTP/1.1\r\n{host}\r\nX : a\r\n\r\n",
                     f"GET {path} HTTP/1.1\r\n{host}\r\n: a\r\n\r\n", f"GET {path} HTTP/1.1\r\n{host}\r\nX\r\n\r\n",
                     f"GET {path} HTTP/1.1\r\n{host}\r\nX(: a\r\n\r\n", f"GET {path} HTTP/1.1\r\n{host}\r\nX: \x7f\r\n\r\n",
                     f"GET {path} HTTP/1.1\r\n{host}\r\nX: \xe4\r\n\r\n", f"GET {path}\xe4 HTTP/1.1\r\n{host}\r\n\r\n",
                     f"GET {path} HTTP/1.1\r\n{host}\r\nX: a\rb\r\n\r\n", "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", "\0" * 100, "\xff" * 100):
            with self.subTest(text):
                self.refused(400, text.encode("latin-1"))
                self.refused(400, *(bytes([byte]) for byte in text.encode("latin-1")))

    def test_what_asks_for_another_protocol(self):
        for lines, status in ((("Expect: 200-ok",), 417), (("Expect: 100-continue, x", "Content-Length: 5"), 417), (("Expect: 100-continue", "Content-Length: 5"), 413),
                              (("Connection: Upgrade", "Upgrade: websocket", "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA=="), 400),
                              (("Connection: Upgrade, HTTP2-Settings", "Upgrade: h2c", "HTTP2-Settings: AAMAAABkAAQAAP__"), 400)):
            with self.subTest(lines):
                self.refused(status, self.server.request("bake", *lines))

    def test_ranges_are_passed_over(self):
        whole = self.ask().split(b"\r\n\r\n", 1)[1]
        before = self.server.resident_bytes()
        for ranges in ("0-0", "0-", "-1", "5-2", "0-0," * 3000 + "0-0", "0-," * 3000 + "0-"):
            answer = self.ask(f"Range: bytes={ranges}")
            self.assertEqual(statuses(answer), [200], ranges[:20])
            self.assertNotIn(b"Content-Range", answer)
            self.assertEqual(answer.split(b"\r\n\r\n", 1)[1], whole)
        self.refused(431, self.server.request("bake", "Range: bytes=" + "0-," * 10000 + "0-"))
        self.assertLess(self.server.resident_bytes(), before + 20_000_000)

    def test_heads_have_an_end(self):
        for text in (self.server.request("bake", "X: " + "a" * 20000), self.server.request("bake", *(f"X{k}: a" for k in range(1000))),
                     self.server.request("bake", *(f"X{k}:" for k in range(65))), self.server.request(target="/" + "a" * 100000),
                     b"G" * 17000, b"GET / HTTP/1.1\r\n" + b"a" * 100000, b"GET / HTTP/1.1\r\n" + b"a:b\r\n" * 100000):
            with self.subTest(text[:40]):
                self.refused(431, text)
        # Requests up to the limits are accepted.
        self.assertEqual(statuses(self.ask("X: " + "a" * 16000)), [200])
        self.assertEqual(statuses(self.ask(*(f"X{k}:" for k in range(61)))), [200])

    def test_every_beginning_of_a_request(self):
        request = self.server.request("bake", "Origin: http://evil.example")
        for length in range(len(request)):
            self.assertEqual(self.server.send(request[:length], end=True), b"", request[:length])

    def test_every_byte_of_a_request_by_another(self):
        request = self.server.request("bake", "Accept: */*", "Content-Length: 0")
        rule = re.compile(rb"GET /%s/bake HTTP/1\.1\r\nHost:[ \t]*127\.0\.0\.1:%d[ \t]*\r\n" % (self.server.token.encode(), self.server.port))
        seed = random.Random(1)
        for place in range(len(request)):
            for value in {0, 10, 13, 32, 44, 58, 127, 255, seed.randrange(256)} - {request[place]}:
                sent = request[:place] + bytes([value]) + request[place + 1:]
                answer = self.server.send(sent, end=True)
                self.assertLessEqual(len(statuses(answer)), 1, sent)
                if statuses(answer) == [200]:
                    # Host and target are unchanged; the other fields do not matter.
                    self.assertRegex(sent.replace(b"host", b"Host"), rule)

    def test_noise(self):
        seed = random.Random(2)
        words = [b"GET ", b"POST ", b" HTTP/1.1", b"\r\n", b"\r\n\r\n", b"Host: ", b"Content-Length: ", b"9", b"\0", b"\n", b":", b"chunked", b"Transfer-Encoding: ",
                 self.server.path("bake").encode(), f"127.0.0.1:{self.server.port}".encode(), b" ", b"\xff"]
        for _ in range(300):
            sent = b"".join(seed.choices(words, k=seed.randrange(1, 40)))
            for status in statuses(self.server.send(sent, end=True)):
                self.assertIn(status, (200, 400, 403, 405, 413, 417, 431, 501))


class Bounds(Serving):
    def until(self, seconds, is_so, what):
        end = time.monotonic() + seconds
        while not is_so():
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.02)

    def test_a_head_that_comes_slowly_is_cut_off(self):
        request = self.server.request()
        begin = time.monotonic()
        links = [self.server.connect(), self.server.connect(request[:20]), self.server.connect(b"GET / HTTP/1.1\r\n")]
        slow = self.server.connect()
        sent = 0
        try:
            while time.monotonic() - begin < HEAD_SECONDS + SLACK:
                slow.sendall(request[sent:sent + 1])  # a byte now and then, as if more would follow
                sent += 1
                time.sleep(0.1)
        except (BrokenPipeError, ConnectionResetError):
            pass
        took = time.monotonic() - begin
        self.assertLess(sent, len(request))
        self.assertGreater(took, HEAD_SECONDS - 0.1)
        self.assertLess(took, HEAD_SECONDS + SLACK)
        for link in [*links, slow]:
            try:
                self.assertEqual(link.recv(100), b"")  # without a word
            except ConnectionResetError:
                pass
            link.close()

    def test_a_second_head_has_its_own_time(self):
        link = self.server.connect(self.server.request("nothing-to-wait-for")[:-2])
        link.close()
        answer = self.server.send(self.server.request() + b"GET ", end=False)
        self.assertEqual(statuses(answer), [200])

    def is_open(self, link):
        """Whether the server has not closed the connection, which awaits nothing."""
        link.settimeout(0.001)
        try:
            return link.recv(1) != b""
        except TimeoutError:
            return True
        except ConnectionError:
            return False

    def test_those_without_the_token_have_few_places_and_the_oldest_gives_way(self):
        before = self.server.open_sockets()
        links = [self.server.connect() for _ in range(250)]
        self.until(SLACK, lambda: self.server.open_sockets() <= before + STRANGERS, "more than the bound are open")
        self.until(SLACK, lambda: sum(map(self.is_open, links)) <= STRANGERS, "the oldest stay")
        # None of them sent anything: the server must close them itself.
        self.until(HEAD_SECONDS + SLACK, lambda: self.server.open_sockets() <= before, "silent ones stay")
        for link in links:
            link.close()

    def test_nobody_keeps_out_who_has_the_token(self):
        request, page = self.server.request(), self.server.request("")
        other = self.server.request(target="/" + "0" * 32 + "/bake")
        mine = self.server.connect(request)  # stays connected meanwhile
        self.assertEqual(statuses(self.read_whole(mine)), [200])
        for begins in ([b""], [b"G"], [request[:-1]], [other[:-1]], [other], [b"POST / HTTP/1.1\r\nContent-Length: 999999999\r\n\r\nx"],
                       [b"\0" * 9], [b"", request[:30], other, b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 60]):
            with self.subTest(begins):
                links = [self.server.connect(begins[k % len(begins)]) for k in range(300)]
                for _ in range(3):
                    self.assertEqual(statuses(self.ask()), [200])
                    self.assertEqual(statuses(self.server.send(page, end=True)), [200])
                    self.assertEqual(statuses(self.listen_for_a_moment()), [200])
                    mine.sendall(request)
                    self.assertEqual(statuses(self.read_whole(mine)), [200])
                for link in links:
                    link.close()
        mine.close()

    def test_a_flood_of_connections_keeps_nobody_out(self):
        ends = threading.Event()
        def flood():
            links = []
            while not ends.is_set():
                try:
                    links.append(socket.create_connection(("127.0.0.1", self.server.port), timeout=5))
                except OSError:
                    pass
                for link in links[:-100]:
                    link.close()
                links = links[-100:]
            for link in links:
                link.close()
        threads = [threading.Thread(target=flood) for _ in range(2)]
        for thread in threads:
            thread.start()
        try:
            for _ in range(20):
                self.assertEqual(statuses(self.ask()), [200])
        finally:
            ends.set()
            for thread in threads:
                thread.join()

    def test_of_those_with_the_token_the_longest_idle_gives_way(self):
        request = self.server.request()
        links = []
        for _ in range(CONNECTIONS + 20):
            links.append(self.server.connect(request))
            self.assertEqual(statuses(self.read_whole(links[-1])), [200])
        self.assertEqual([self.is_open(link) for link in links], [False] * 20 + [True] * CONNECTIONS)
        # One that is busy stays.
        with self.server.connect(self.server.request("events")) as listener:
            self.read_until(listener, b"\n\n")
            for _ in range(CONNECTIONS):
                links.append(self.server.connect(request))
                self.assertEqual(statuses(self.read_whole(links[-1])), [200])
            self.assertTrue(self.is_open(listener))
        for link in links:
            link.close()

    def test_without_descriptors_it_waits_and_lets_in_again(self):
        pid = self.server.process.pid
        whole = resource.prlimit(pid, resource.RLIMIT_NOFILE)
        highest = max(map(int, os.listdir(f"/proc/{pid}/fd")))
        try:
            # With none for a connection, some for strangers only.
            for more in (0, 1, 5):
                resource.prlimit(pid, resource.RLIMIT_NOFILE, (highest + 1 + more, whole[1]))
                links = [self.server.connect() for _ in range(30)]
                before = self.server.processor_ticks()
                time.sleep(0.5)
                self.assertLess(self.server.processor_ticks() - before, 25)  # it does not spin: of 50
                if more > 0:
                    self.assertEqual(statuses(self.ask()), [200])
                for link in links:
                    link.close()
        finally:
            resource.prlimit(pid, resource.RLIMIT_NOFILE, whole)
        self.assertEqual(statuses(self.ask()), [200])

    def read_whole(self, link):
        """One answer on a connection that stays open."""
        answer = self.read_until(link, b"\r\n\r\n")
        length = int(re.search(rb"Content-Length: (\d+)", answer)[1])
        while len(answer.split(b"\r\n\r\n", 1)[1]) < length:
            piece = link.recv(65536)
            self.assertTrue(piece)
            answer += piece
        return answer

    def test_so_many_listeners(self):
        links = []
        for _ in range(STREAMS):
            links.append(self.server.connect(self.server.request("events")))
            self.assertIn(b"event: baked", self.read_until(links[-1], b"\n\n"))
        self.refused(503, self.server.request("events"))
        self.assertEqual(statuses(self.ask()), [200])
        links.pop().close()
        self.until(SLACK, lambda: statuses(self.listen_for_a_moment()) == [200], "one that went away still counts")
        for link in links:
            link.close()

    def listen_for_a_moment(self):
        with self.server.connect(self.server.request("events")) as link:
            link.settimeout(10)
            return self.read_until(link, b"\r\n\r\n")

    def read_until(self, link, end):
        text = b""
        while end not in text:
            piece = link.recv(65536)
            if not piece:
                break
            text += piece
        return text

    def test_a_listener_has_nothing_to_say(self):
        answer = self.server.send(self.server.request("events"), self.server.request("bake"))
        self.assertEqual(statuses(answer), [200])
        self.assertNotIn(b"octet-stream", answer)
        answer = self.server.send(self.server.request("events") + self.server.request("bake"))
        self.assertEqual(statuses(answer), [200])


@unittest.skipUnless(HAS_PAGE, "this build has no page")
class Slow(Command):
    """Clients that request but do not read, and Ctrl-C."""

    def setUp(self):
        super().setUp()
        self.server = None

    def tearDown(self):
        if self.server:
            self.server.kill()

    def start(self, text):
        self.server = Server(self.write("scene.xml", text))
        self.server.wait_for("baked")
        return self.server

    def is_cut(self, link, seconds):
        """Whether the server closes the connection; found without reading from it."""
        poll = select.poll()
        poll.register(link, 0)  # errors and hang-ups only
        return bool(poll.poll(1000 * seconds))

    def test_those_who_do_not_read_are_dropped_and_cost_nothing(self):
        large = SCENE.format(end=60).replace('columns="13" rows="11"', 'columns="160" rows="160"').replace("</scene>", EVENTS)
        server = self.start(large)
        self.assertGreater(len(server.get("bake")[1]), 2_000_000)  # more than the system takes for them
        # Several hundred lines with an error each.
        wrong = SCENE.format(end=60).replace("</scene>", "".join(
            f'<point name="p{k}" {"x" * 90}="1"/>\n' for k in range(300)) + "</scene>")
        links = []
        for place in ["events"] * (STREAMS - 1) + ["bake"] * 20:
            link = socket.socket()
            link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            link.connect(("127.0.0.1", server.port))
            link.sendall(server.request(place))
            links.append(link)
        listeners, takers = links[:STREAMS - 1], links[STREAMS - 1:]
        begin = time.monotonic()
        os.replace(self.write("next.xml", wrong), self.path("scene.xml"))
        told = server.wait_for("failed")
        self.assertGreater(len(told), 20_000)
        self.assertLess(len(told), 300_000)
        self.assertIn("more errors; see the terminal", told)
        before = server.resident_bytes()
        for k in range(40):
            # Atomically, so that no incomplete save is read.
            os.replace(self.write("next.xml", wrong + "<!--" + "x" * k + "-->"), self.path("scene.xml"))
            server.wait_for("failed")
        # Storing each event for each listener would need 10 MB or more. Sanitizers keep freed
        # memory.
        if not SANITIZED:
            self.assertLess(server.resident_bytes() - before, 5_000_000)
        for link in (*takers, *listeners):
            left = max(0.1, begin + WRITE_SECONDS + 3 * SLACK - time.monotonic())
            self.assertTrue(self.is_cut(link, left))
            link.close()
        self.assertEqual(server.get("")[0], 200)

    def test_ctrl_c_ends_it_at_once_whoever_is_connected(self):
        server = self.start(SCENE.format(end=4))
        request = server.request()
        links = [server.connect(*pieces) for pieces in
                 [()] * 10 + [(request[:30],)] * 10 + [(request,)] * 10 + [(server.request("events"),)] * 10 +
                 [(server.request(host="evil.example", method="POST"),)] * 10]
        time.sleep(0.3)
        begin = time.monotonic()
        server.process.send_signal(signal.SIGINT)
        server.process.wait(timeout=30)
        took = time.monotonic() - begin
        code, _, errors = server.close()
        self.assertEqual((code, errors), (0, ""))
        self.assertLess(took, 1 if not SANITIZED else 5)
        for link in links:
            link.close()


if __name__ == "__main__":
    main()
