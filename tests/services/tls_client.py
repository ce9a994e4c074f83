"""TLS as others speak it. `broker PORT FOLDER`: what a broker has; `pages WEB METRICS FOLDER`: the page and the metrics."""
import http.client
import socket
import ssl
import sys
import time

what, *ports, folder = sys.argv[1:]


def broker(port):
    from paho.mqtt import client as mqtt

    found = []
    old = getattr(mqtt, "CallbackAPIVersion", None)
    client = mqtt.Client(old.VERSION1, "listener") if old else mqtt.Client("listener")
    client.tls_set(ca_certs=f"{folder}/ca.pem", certfile=f"{folder}/client.pem", keyfile=f"{folder}/client.key")
    client.on_message = lambda _, __, message: found.append((message.topic, message.payload))
    client.connect("127.0.0.1", int(port))
    client.subscribe("plant/#")
    client.loop_start()
    until = time.time() + 10
    while ("plant/state", b"RUN") not in found or not any(topic == "plant/value/MW10" for topic, _ in found):
        assert time.time() < until, found
        time.sleep(0.05)
    client.loop_stop()


def get(port, path, context, headers={}):
    connection = http.client.HTTPSConnection("127.0.0.1", int(port), timeout=10, context=context)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    return answer.status, b"" if answer.status == 101 else answer.read()


def pages(web, metrics):
    context = ssl.create_default_context(cafile=f"{folder}/certificate.pem")
    status, page = get(web, "/", context)
    assert status == 200 and b"<html" in page, (status, page[:100])
    status, page = get(metrics, "/metrics", context)
    assert status == 200 and b"plc_running 1" in page, (status, page)
    upgrade = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13",
               "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==", "Origin": f"https://127.0.0.1:{web}"}
    assert get(web, "/live", context, upgrade)[0] == 101
    # By the name, and with the older version.
    context.maximum_version = ssl.TLSVersion.TLSv1_2
    with socket.create_connection(("127.0.0.1", int(metrics)), timeout=10) as plain:
        with context.wrap_socket(plain, server_hostname="localhost") as stream:
            assert stream.version() == "TLSv1.2"
    # A client that does not know the certificate, and one without TLS.
    for wrong in (lambda: get(web, "/", ssl.create_default_context()), lambda: without_tls(web)):
        try:
            answer = wrong()
        except (ssl.SSLError, http.client.HTTPException, ConnectionError):
            continue
        raise AssertionError(answer)


def without_tls(port):
    connection = http.client.HTTPConnection("127.0.0.1", int(port), timeout=10)
    connection.request("GET", "/")
    return connection.getresponse().read()


{"broker": broker, "pages": pages}[what](*ports)
print("done")
