"""What the views say of their requests holds: one that is typed as signed in has refused everybody else."""

import inspect
from collections.abc import Iterator
from typing import Any

import pytest
from django.contrib.auth.models import AnonymousUser
from django.test import RequestFactory
from django.urls import URLPattern, URLResolver, get_resolver
from rest_framework.request import Request
from rest_framework.views import APIView

from workspace.api.signed_in import SignedInRequest

METHODS = ("get", "post", "put", "patch", "delete")


def views(patterns: list[URLPattern | URLResolver]) -> Iterator[type[APIView]]:
    for pattern in patterns:
        if isinstance(pattern, URLResolver):
            yield from views(pattern.url_patterns)
        elif issubclass(view := getattr(pattern.callback, "view_class", object), APIView):
            yield view


def typed_as_signed_in(view: type[APIView]) -> list[str]:
    handlers = {method: getattr(view, method) for method in METHODS if hasattr(view, method)}
    return [
        method for method, handler in handlers.items() if inspect.signature(handler).parameters["request"].annotation is SignedInRequest
    ]


TYPED = sorted(
    {(view, method) for view in views(get_resolver().url_patterns) for method in typed_as_signed_in(view)},
    key=lambda one: (one[0].__module__, one[0].__name__, one[1]),
)


def test_most_views_are_typed() -> None:
    assert len(TYPED) > 100


@pytest.mark.parametrize(("view", "method"), TYPED, ids=[f"{view.__name__}-{method}" for view, method in TYPED])
def test_a_view_whose_user_is_typed_refuses_anonymous_users(view: type[APIView], method: str) -> None:
    asked: Any = Request(RequestFactory().generic(method.upper(), "/"))
    asked.user, asked.auth = AnonymousUser(), None
    assert not all(permission.has_permission(asked, view()) for permission in view().get_permissions())
