"""QR codes of a UAV's secrets, drawn by the page."""

import qrcode


def qr_rows(text: str) -> list[str]:
    """Return the modules of the QR code of a text, a row each: "1" is dark. The quiet zone is left to the page."""
    code = qrcode.QRCode(error_correction=qrcode.ERROR_CORRECT_M, border=0)
    code.add_data(text)
    return ["".join("1" if dark else "0" for dark in row) for row in code.get_matrix()]
