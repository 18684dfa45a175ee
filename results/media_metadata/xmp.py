"""XMP packets as flat properties."""

from collections.abc import Iterator, Mapping
from xml.etree.ElementTree import Element, ParseError

from defusedxml.common import DefusedXmlException
from defusedxml.ElementTree import fromstring

MAX_PACKET_BYTES = 1024 * 1024
MAX_DEPTH = 12
RDF = "w3.org/1999/02/22-rdf-syntax-ns#"

Properties = Mapping[
    tuple[str, str], str
]  # by namespace, as `namespace_key` writes it, and path of names: ("…", "CameraOrientationNED/Yaw")


class XmpFault(ValueError):
    """Raised for a packet that is not read: too large, not XML, or with entities."""


def namespace_key(address: str) -> str:
    """Return a namespace without what differs between firmware versions: scheme, www and the last slash."""
    return address.removeprefix("https://").removeprefix("http://").removeprefix("www.").rstrip("/")


def properties_of(packet: bytes) -> Properties:
    """Return the properties of a packet. Raises XmpFault."""
    if len(packet) > MAX_PACKET_BYTES:
        raise XmpFault("too large")
    try:
        root = fromstring(packet.strip(b"\0 \r\n\t"), forbid_dtd=True)
    except (ParseError, DefusedXmlException, ValueError) as error:
        raise XmpFault(str(error)) from error
    return dict(_properties(root, (), MAX_DEPTH))


def _properties(element: Element, path: tuple[str, ...], depth: int) -> Iterator[tuple[tuple[str, str], str]]:
    """Yield the properties in an element: attributes, texts, and those of structures under their parent's name."""
    if depth == 0:
        raise XmpFault("nested too deep")
    for name, value in element.attrib.items():
        namespace, local = _split(name)
        if namespace and namespace != RDF:
            yield (namespace, "/".join((*path, local))), value.strip()
    for child in element:
        namespace, local = _split(child.tag)
        if namespace in (RDF, "adobe:ns:meta"):
            yield from _properties(child, path, depth - 1)
            continue
        inner = (*path, local)
        if len(child) == 0 and child.text and child.text.strip():
            yield (namespace, "/".join(inner)), child.text.strip()
        yield from _properties(child, inner, depth - 1)


def _split(name: str) -> tuple[str, str]:
    namespace, _, local = name.rpartition("}")
    return namespace_key(namespace.removeprefix("{")), local
