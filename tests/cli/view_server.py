"""`pliant view --serve` for its tests: requests byte by byte, and a listener to events."""

import http.client
import os
import re
import signal
import socket
import subprocess
import tempfile
import time

from command import PLIANT

# A build without the page fails with 1, before it looks for the scene (2).
HAS_PAGE = subprocess.run([PLIANT, "view", "no-such-scene.xml"], capture_output=True, check=False, timeout=60).returncode == 2


def exchange(port, *pieces, end=False, timeout=20):
    """Sends the pieces and returns everything received until the server closes the connection;
    TimeoutError if it does not. `end`: also closes our sending side."""
    with socket.create_connection(("127.0.0.1", port), timeout=timeout) as link:
        link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        answer = b""
        try:
            for piece in pieces:
                link.sendall(piece)
            if end:
                link.shutdown(socket.SHUT_WR)
        except (BrokenPipeError, ConnectionResetError):  # closed while we were sending
            pass
        try:
            limit = time.monotonic() + timeout
            while piece := link.recv(65536):
                answer += piece
                if time.monotonic() > limit:  # for a stream that never ends
                    raise TimeoutError(f"it is still open: {answer[-200:]}")
        except ConnectionResetError:
            pass
        return answer


def statuses(stream):
    """The statuses of all answers, each of its stated length; otherwise ValueError."""
    found = []
    while stream:
        head, _, rest = stream.partition(b"\r\n\r\n")
        status = re.match(rb"HTTP/1\.1 (\d+) ", head)
        length = re.search(rb"\r\nContent-Length: (\d+)", head)
        if not status or (length and int(length.group(1)) > len(rest)):
            raise ValueError(f"no answer: {stream[:200]}")
        found.append(int(status.group(1)))
        stream = rest[int(length.group(1)):] if length else b""
    return found


class Server:
    """The command, and a listener to its events."""

    def __init__(self, scene):
        # A file, since a pipe without a reader would block a command with much output.
        self.errors = tempfile.TemporaryFile("w+", encoding="utf-8")
        self.process = subprocess.Popen([PLIANT, "view", scene, "--serve"], stdout=subprocess.PIPE,
                                        stderr=self.errors, text=True)
        self.address = self.process.stdout.readline().rstrip("\n")
        port, self.token = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/([0-9a-f]{32})/", self.address).groups()
        self.port = int(port)
        self.events = http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)
        self.events.request("GET", self.path("events"))
        self.stream = self.events.getresponse()

    def path(self, place):
        return f"/{self.token}/{place}"

    def get(self, place, headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)
        connection.request("GET", self.path(place), headers=headers or {})
        response = connection.getresponse()
        body = response.read()
        connection.close()
        return response.status, body

    def request(self, place="bake", *lines, method="GET", target=None, host=None):
        """The bytes of a valid request, unless `lines` make it invalid."""
        target = self.path(place) if target is None else target
        host = f"127.0.0.1:{self.port}" if host is None else host
        return "\r\n".join([f"{method} {target} HTTP/1.1", f"Host: {host}", *lines, "", ""]).encode("latin-1")

    def send(self, *pieces, **options):
        return exchange(self.port, *pieces, **options)

    def connect(self, *pieces):
        """An open connection, after sending some bytes."""
        link = socket.create_connection(("127.0.0.1", self.port), timeout=20)
        for piece in pieces:
            link.sendall(piece)
        return link

    def resident_bytes(self):
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as file:
            return 1024 * int(re.search(r"VmRSS:\s*(\d+)", file.read()).group(1))

    def processor_ticks(self):
        """The time that all its threads have computed, in hundredths of a second."""
        with open(f"/proc/{self.process.pid}/stat", encoding="utf-8") as file:
            return sum(map(int, file.read().rpartition(") ")[2].split()[11:13]))

    def open_sockets(self):
        folder = f"/proc/{self.process.pid}/fd"
        count = 0
        for name in os.listdir(folder):
            try:
                count += os.readlink(os.path.join(folder, name)).startswith("socket:")
            except OSError:  # just closed
                pass
        return count

    def wait_for(self, name):
        """The data of the next event of that name."""
        while True:
            line = self.stream.readline().decode()
            if not line:
                raise EOFError(f"the events ended ahead of \"{name}\", with {self.stream.status}")
            if line.rstrip("\n") == f"event: {name}":
                return self.stream.readline().decode().rstrip("\n").removeprefix("data: ")

    def stop_listening(self):
        self.stream.close()
        self.events.close()

    def close(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        out, _ = self.process.communicate(timeout=120)
        self.stop_listening()
        with self.errors:
            self.errors.seek(0)
            return self.process.returncode, out, self.errors.read()

    def kill(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate()
            self.stop_listening()
            self.errors.close()
